#include "models/serial_arm.hpp"

#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <stdexcept>
#include <string>
#include <utility>

namespace stillcut {
namespace {

KDL::Vector to_kdl(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

KDL::Chain chain_of(const Arm& arm) {
  KDL::Chain chain;
  for (const ArmJoint& joint : arm.joints) {
    const Eigen::Matrix3d& r = joint.turned;
    const KDL::Rotation turned(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2));
    const KDL::Vector origin = to_kdl(joint.origin);
    const Eigen::Matrix3d& i = joint.inertia;
    const KDL::RotationalInertia inertia(i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2));
    chain.addSegment(
        KDL::Segment(joint.name, KDL::Joint(joint.name, origin, turned * to_kdl(joint.axis), KDL::Joint::RotAxis),
                     KDL::Frame(turned, origin), KDL::RigidBodyInertia(joint.mass, to_kdl(joint.centre), inertia)));
  }
  chain.addSegment(KDL::Segment("tool", KDL::Joint("tool", KDL::Joint::None), KDL::Frame(to_kdl(arm.tool))));
  return chain;
}

}  // namespace

struct SerialArm::Solvers {
  explicit Solvers(Arm described)
      : arm{std::move(described)},
        chain{chain_of(arm)},
        dynamics{chain, KDL::Vector(0.0, 0.0, -arm.gravity)},
        place{chain},
        jacobian{chain},
        angles(chain.getNrOfJoints()),
        velocities(chain.getNrOfJoints()) {}

  void set(const JointVector& q, const JointVector& v) {
    if (q.size() != arm.size() || v.size() != arm.size())
      throw std::invalid_argument("a posture has another number of joints than the arm");
    angles.data = q;
    velocities.data = v;
  }
  static void demand(int result, const char* what) {
    if (result < 0) throw std::runtime_error(std::string("KDL: ") + what + " failed (" + std::to_string(result) + ")");
  }

  Arm arm;
  KDL::Chain chain;
  KDL::ChainDynParam dynamics;
  KDL::ChainFkSolverPos_recursive place;
  KDL::ChainJntToJacSolver jacobian;
  KDL::JntArray angles, velocities;
};

SerialArm::SerialArm(Arm arm) {
  check_arm(arm);
  solvers_ = std::make_unique<Solvers>(std::move(arm));
}
SerialArm::~SerialArm() = default;
SerialArm::SerialArm(SerialArm&&) noexcept = default;
SerialArm& SerialArm::operator=(SerialArm&&) noexcept = default;

const Arm& SerialArm::description() const { return solvers_->arm; }

Eigen::Vector3d SerialArm::tool(const JointVector& angles) {
  solvers_->set(angles, JointVector::Zero(angles.size()));
  KDL::Frame frame;
  Solvers::demand(solvers_->place.JntToCart(solvers_->angles, frame), "the tool's place");
  return {frame.p.x(), frame.p.y(), frame.p.z()};
}

ToolJacobian SerialArm::jacobian(const JointVector& angles) {
  solvers_->set(angles, JointVector::Zero(angles.size()));
  KDL::Jacobian jacobian(solvers_->chain.getNrOfJoints());
  Solvers::demand(solvers_->jacobian.JntToJac(solvers_->angles, jacobian), "the Jacobian");
  return jacobian.data.topRows<3>();
}

EquationsOfMotion SerialArm::equations(const JointVector& angles, const JointVector& velocities) {
  solvers_->set(angles, velocities);
  const unsigned n = solvers_->chain.getNrOfJoints();
  KDL::JntSpaceInertiaMatrix mass(n);
  KDL::JntArray coriolis(n), gravity(n);
  Solvers::demand(solvers_->dynamics.JntToMass(solvers_->angles, mass), "the mass matrix");
  Solvers::demand(solvers_->dynamics.JntToCoriolis(solvers_->angles, solvers_->velocities, coriolis),
                  "the gyroscopic terms");
  Solvers::demand(solvers_->dynamics.JntToGravity(solvers_->angles, gravity), "gravity");
  return {mass.data, coriolis.data, gravity.data};
}

LinearArm SerialArm::linearised(const JointVector& angles) {
  LinearArm linear = linear_arm(solvers_->arm, angles);
  linear.mass = equations(angles, JointVector::Zero(angles.size())).mass;
  linear.jacobian = jacobian(angles);
  return linear;
}

}  // namespace stillcut
