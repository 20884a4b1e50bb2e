#include "drivers/files/robot_file.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "drivers/files/input_error.hpp"
#include "drivers/files/robot_xml.hpp"

namespace stillcut {
namespace {

constexpr std::array<std::string_view, 3> kUsualToolLinks{"tool", "tcp", "tool0"};

// Links that no joint moves against one another: one body, described in the frame of the first of them.
struct RigidBody {
  double mass = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();      // kg m, sum of mass times place
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();     // kg m^2, about the frame's origin
  std::vector<std::pair<std::string, UrdfPlace>> links;  // every link's frame
};

UrdfPlace operator*(const UrdfPlace& outer, const UrdfPlace& inner) {
  return {outer.origin + outer.turned * inner.origin, outer.turned * inner.turned};
}

// m (r.r 1 - r r^T): what a mass away from the axes adds to an inertia.
Eigen::Matrix3d point_inertia(double mass, const Eigen::Vector3d& r) {
  return mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
}

class ArmBuilder {
 public:
  ArmBuilder(const UrdfRobot& robot, std::string file) : robot_{robot}, file_{std::move(file)} {}

  Arm build() {
    check_tree();
    arm_.name = robot_.name;
    const UrdfLink* first = &root();
    RigidBody body = body_of(*first, nullptr);
    for (const UrdfJoint* joint = next_joint(body); joint != nullptr; joint = next_joint(body)) {
      if (arm_.size() == kMostJoints)
        fail(joint->line, "the arm has more than " + std::to_string(kMostJoints) + " joints that move");
      const UrdfPlace before = place_in(body, joint->parent);
      body = body_of(link_named(joint->child, joint->line), joint);
      add(*joint, before * joint->place, body);
    }
    if (visited_ != robot_.joints.size()) fail(robot_.line, "has joints that form a loop; give the arm as a chain");
    if (arm_.joints.empty()) fail(robot_.line, "has no joint that moves; give revolute joints");
    set_tool(body);
    return arm_;
  }

  [[nodiscard]] int line_of_joint(std::string_view message) const {  // named in the message: "joint NAME: ..."
    for (const UrdfJoint& joint : robot_.joints) {
      if (message.starts_with("joint " + joint.name + ":")) return joint.line;
    }
    return robot_.line;
  }

 private:
  [[noreturn]] void fail(int line, const std::string& message) const { throw InputError(file_, line, message); }

  const UrdfLink& link_named(const std::string& name, int line) const {
    for (const UrdfLink& link : robot_.links) {
      if (link.name == name) return link;
    }
    fail(line, "there is no link \"" + name + "\"; add it or correct the name");
  }

  void check_tree() const {
    if (robot_.links.empty()) fail(robot_.line, "has no link; is it a URDF file?");
    for (const UrdfJoint& joint : robot_.joints) {
      (void)link_named(joint.parent, joint.line);
      (void)link_named(joint.child, joint.line);
      for (const UrdfJoint& other : robot_.joints) {
        if (&other != &joint && other.child == joint.child)
          fail(std::max(joint.line, other.line), "link " + joint.child + " hangs on two joints, " + joint.name +
                                                     " and " + other.name + "; give the arm as a chain");
      }
    }
  }

  const UrdfLink& root() const {
    const UrdfLink* found = nullptr;
    for (const UrdfLink& link : robot_.links) {
      const bool hangs = std::any_of(robot_.joints.begin(), robot_.joints.end(),
                                     [&](const UrdfJoint& joint) { return joint.child == link.name; });
      if (hangs) continue;
      if (found != nullptr)
        fail(link.line,
             "link " + link.name + " hangs on no joint, nor does " + found->name + "; join it to the arm or remove it");
      found = &link;
    }
    if (found == nullptr) fail(robot_.line, "has joints that form a loop; give the arm as a chain");
    return *found;
  }

  RigidBody body_of(const UrdfLink& link, const UrdfJoint* joint) {
    RigidBody body;
    body.links.emplace_back(link.name, UrdfPlace{});
    for (std::size_t i = 0; i < body.links.size(); ++i) {  // grows on the way
      const auto [name, place] = body.links[i];
      const UrdfLink& part = link_named(name, robot_.line);
      const UrdfPlace at = place * part.place;
      body.mass += part.mass;
      body.moment += part.mass * at.origin;
      body.inertia += at.turned * part.inertia * at.turned.transpose() + point_inertia(part.mass, at.origin);
      for (const UrdfJoint& fixed : robot_.joints) {
        if (fixed.parent != name) continue;
        ++visited_;
        if (!fixed.moves) body.links.emplace_back(fixed.child, place * fixed.place);
      }
    }
    if (joint != nullptr && !(body.mass > 0.0))
      fail(link.line, "link " + link.name + " has no <inertial> with a mass; give mass, centre and inertia (from CAD)");
    return body;
  }

  const UrdfJoint* next_joint(const RigidBody& body) const {
    const UrdfJoint* next = nullptr;
    for (const UrdfJoint& joint : robot_.joints) {
      const bool here = std::any_of(body.links.begin(), body.links.end(),
                                    [&](const auto& link) { return link.first == joint.parent; });
      if (!joint.moves || !here) continue;
      if (next != nullptr)
        fail(joint.line, "the arm branches: " + next->name + " and " + joint.name +
                             " hang on one body; keep the chain to the tool and fix the other joint");
      next = &joint;
    }
    return next;
  }

  static UrdfPlace place_in(const RigidBody& body, const std::string& link) {
    return std::find_if(body.links.begin(), body.links.end(), [&](const auto& l) { return l.first == link; })->second;
  }

  void add(const UrdfJoint& joint, const UrdfPlace& place, const RigidBody& body) {
    if (!joint.stiffness)
      fail(joint.line,
           "joint " + joint.name + " has no stiffness; add <stillcut stiffness_n_m_per_rad=\"...\"/> in it");
    ArmJoint made;
    made.name = joint.name;
    made.origin = place.origin;
    made.turned = place.turned;
    made.axis = joint.axis;
    made.stiffness = *joint.stiffness;
    made.damping = joint.damping;
    made.lower = joint.lower.value_or(made.lower);
    made.upper = joint.upper.value_or(made.upper);
    made.home = joint.home.value_or(std::clamp(0.0, made.lower, made.upper));
    made.mass = body.mass;
    made.centre = body.moment / body.mass;
    made.inertia = body.inertia - point_inertia(body.mass, made.centre);
    made.inertia = (0.5 * (made.inertia + made.inertia.transpose())).eval();
    arm_.joints.push_back(made);
  }

  void set_tool(const RigidBody& last) {
    std::string name = robot_.tool_link;
    int line = robot_.tool_line;
    if (name.empty()) {
      const auto usual = std::find_if(robot_.links.begin(), robot_.links.end(), [](const UrdfLink& link) {
        return std::find(kUsualToolLinks.begin(), kUsualToolLinks.end(), link.name) != kUsualToolLinks.end();
      });
      if (usual == robot_.links.end())
        fail(robot_.line, "names no tool link; add <stillcut tool_link=\"...\"/> in <robot>, or a link called tool");
      name = usual->name;
      line = usual->line;
    }
    (void)link_named(name, line);
    for (const auto& [link, place] : last.links) {
      if (link != name) continue;
      arm_.tool = place.origin;
      return;
    }
    fail(line, "the tool link " + name + " does not hang on the last joint, " + arm_.joints.back().name +
                   "; name one that does");
  }

  const UrdfRobot& robot_;
  std::string file_;
  Arm arm_;
  std::size_t visited_ = 0;  // joints that the chain has come by
};

}  // namespace

Arm read_robot(const std::filesystem::path& file) {
  const UrdfRobot robot = read_urdf(file);
  ArmBuilder builder(robot, file.string());
  Arm arm = builder.build();
  try {
    check_arm(arm);
  } catch (const std::invalid_argument& error) {
    throw InputError(file.string(), builder.line_of_joint(error.what()), error.what());
  }
  return arm;
}

}  // namespace stillcut
