#include "drivers/files/robot_xml.hpp"

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <string_view>

#include "drivers/files/input_error.hpp"
#include "drivers/files/spelling.hpp"
#include "drivers/files/text_file.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

using tinyxml2::XMLElement;

class UrdfReader {
 public:
  explicit UrdfReader(std::string file) : file_{std::move(file)} {}

  [[noreturn]] void fail(const XMLElement& at, const std::string& message) const {
    throw InputError(file_, at.GetLineNum(), message);
  }

  [[nodiscard]] std::string text(const XMLElement& at, const char* name) const {
    const char* value = at.Attribute(name);
    if (value == nullptr || *value == '\0') fail(at, tag(at) + " has no " + name + "; add " + name + "=\"...\"");
    return value;
  }

  template <std::size_t N>
  [[nodiscard]] std::array<double, N> numbers(const XMLElement& at, std::string_view what,
                                              std::string_view value) const {
    std::array<double, N> result{};
    std::size_t count = 0;
    bool good = true;
    while (good) {
      value.remove_prefix(std::min(value.find_first_not_of(" \t\r\n"), value.size()));
      if (value.empty()) break;
      if (value.front() == '+') value.remove_prefix(1);
      double number = 0.0;
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
      good = count < N && error == std::errc{} && std::isfinite(number);
      if (good) result[count++] = number;
      value.remove_prefix(static_cast<std::size_t>(end - value.data()));
      good = good && (value.empty() || std::string_view(" \t\r\n").find(value.front()) != std::string_view::npos);
    }
    if (!good || count != N)
      fail(at,
           tag(at) + ": " + std::string(what) + " is not " + (N == 1 ? "a number" : std::to_string(N) + " numbers"));
    return result;
  }

  [[nodiscard]] double number(const XMLElement& at, const char* name) const {
    return numbers<1>(at, name, text(at, name))[0];
  }
  [[nodiscard]] std::optional<double> optional_number(const XMLElement& at, const char* name) const {
    if (at.Attribute(name) == nullptr) return {};
    return number(at, name);
  }
  [[nodiscard]] Eigen::Vector3d vector(const XMLElement& at, const char* name) const {
    if (at.Attribute(name) == nullptr) return Eigen::Vector3d::Zero();
    const auto value = numbers<3>(at, name, at.Attribute(name));
    return {value[0], value[1], value[2]};
  }

  [[nodiscard]] const XMLElement& child(const XMLElement& of, const char* name, const char* what_to_do) const {
    const XMLElement* found = of.FirstChildElement(name);
    if (found == nullptr) fail(of, tag(of) + " has no <" + name + ">; " + what_to_do);
    return *found;
  }

  [[nodiscard]] UrdfPlace place(const XMLElement& of) const {
    const XMLElement* origin = of.FirstChildElement("origin");
    if (origin == nullptr) return {};
    const Eigen::Vector3d rpy = vector(*origin, "rpy");
    const Eigen::Matrix3d turned =
        (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    return {vector(*origin, "xyz"), turned};
  }

  // Our own element: a misspelt attribute would silently be none.
  void check_own(const XMLElement& at, std::span<const std::string> known) const {
    for (const auto* attribute = at.FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
      const std::string name = attribute->Name();
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      const std::string_view near = nearest_name(name, known);
      fail(at, "<stillcut> has no \"" + name + "\"; " +
                   (near.empty() ? "it knows " + known.front() : "did you mean " + std::string(near)) + "?");
    }
  }

  [[nodiscard]] UrdfLink link(const XMLElement& at) const {
    UrdfLink link;
    link.name = text(at, "name");
    link.line = at.GetLineNum();
    const XMLElement* inertial = at.FirstChildElement("inertial");
    if (inertial == nullptr) return link;
    link.mass = number(child(*inertial, "mass", "add <mass value=\"...\"/>"), "value");
    if (!(link.mass >= 0.0)) fail(*inertial, "the mass of " + link.name + " is negative");
    const XMLElement& i = child(*inertial, "inertia", "add <inertia ixx=... iyy=... izz=.../>");
    const auto product = [&](const char* name) { return optional_number(i, name).value_or(0.0); };
    const double xy = product("ixy"), xz = product("ixz"), yz = product("iyz");
    link.inertia << number(i, "ixx"), xy, xz, xy, number(i, "iyy"), yz, xz, yz, number(i, "izz");
    link.place = place(*inertial);
    return link;
  }

  [[nodiscard]] UrdfJoint joint(const XMLElement& at) const {
    UrdfJoint joint;
    joint.name = text(at, "name");
    joint.line = at.GetLineNum();
    joint.parent = text(child(at, "parent", "add <parent link=\"...\"/>"), "link");
    joint.child = text(child(at, "child", "add <child link=\"...\"/>"), "link");
    joint.place = place(at);
    const std::string type = text(at, "type");
    if (type == "fixed") return joint;
    if (type != "revolute" && type != "continuous")
      fail(at, "joint " + joint.name + " is " + type + "; only revolute, continuous and fixed joints are supported");
    if (at.FirstChildElement("mimic") != nullptr)
      fail(at, "joint " + joint.name + " mimics another; give the arm as a chain of independent joints");
    joint.moves = true;
    if (const XMLElement* axis = at.FirstChildElement("axis")) joint.axis = vector(*axis, "xyz");
    if (!(joint.axis.norm() > 0.0)) fail(at, "the axis of joint " + joint.name + " has no length");
    joint.axis.normalize();
    if (const XMLElement* limit = at.FirstChildElement("limit"); limit != nullptr && type == "revolute") {
      joint.lower = optional_number(*limit, "lower");
      joint.upper = optional_number(*limit, "upper");
      if (joint.lower.value_or(0.0) > joint.upper.value_or(0.0))
        fail(*limit, "the limits of joint " + joint.name + " exclude every angle; lower is above upper");
    }
    if (const XMLElement* dynamics = at.FirstChildElement("dynamics"))
      joint.damping = optional_number(*dynamics, "damping").value_or(0.0);
    if (!(joint.damping >= 0.0)) fail(at, "the damping of joint " + joint.name + " is negative");
    if (const XMLElement* own = at.FirstChildElement("stillcut")) {
      static const std::array<std::string, 2> kKnown{"stiffness_n_m_per_rad", "home_deg"};
      check_own(*own, kKnown);
      joint.stiffness = optional_number(*own, "stiffness_n_m_per_rad");
      if (joint.stiffness && !(*joint.stiffness > 0.0))
        fail(*own, "the stiffness of joint " + joint.name + " must be above 0");
      if (const auto home = optional_number(*own, "home_deg")) joint.home = deg_to_rad(*home);
    }
    return joint;
  }

  // Gazebo's way; what stands in the joint itself comes first.
  void spring(const XMLElement& at, std::vector<UrdfJoint>& joints) const {
    const XMLElement* stiffness = at.FirstChildElement("springStiffness");
    const char* reference = at.Attribute("reference");
    if (stiffness == nullptr || reference == nullptr) return;
    const auto joint = std::find_if(joints.begin(), joints.end(), [&](const auto& j) { return j.name == reference; });
    if (joint == joints.end()) fail(at, "springStiffness is for \"" + std::string(reference) + "\", which is no joint");
    if (joint->stiffness) return;
    const char* value = stiffness->GetText();
    joint->stiffness = numbers<1>(*stiffness, "its value", value == nullptr ? "" : value)[0];
    if (!(*joint->stiffness > 0.0)) fail(*stiffness, "the stiffness of joint " + joint->name + " must be above 0");
  }

 private:
  [[nodiscard]] static std::string tag(const XMLElement& at) {
    const char* name = at.Attribute("name");
    std::string text = "<";
    text.append(at.Name());
    if (name != nullptr) text.append(" name=\"").append(name).append("\"");
    return text.append(">");
  }

  std::string file_;
};

template <class Named>
void check_names(const UrdfReader& reader, const XMLElement& at, const std::vector<Named>& named, const char* what) {
  for (std::size_t i = 0; i + 1 < named.size(); ++i) {
    if (named[i].name == named.back().name)
      reader.fail(at, std::string(what) + " " + named[i].name + " stands twice; give each its own name");
  }
}

}  // namespace

UrdfRobot read_urdf(const std::filesystem::path& file) {
  const std::string text = read_text_file(file);
  const UrdfReader reader(file.string());
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw InputError(file.string(), document.ErrorLineNum(),
                     std::string("is not XML (") + document.ErrorName() + "); a robot is described by a URDF file");
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "robot")
    throw InputError(file.string(), root == nullptr ? 0 : root->GetLineNum(),
                     "has no <robot>; a robot is described by a URDF file (expand xacro first)");
  UrdfRobot robot;
  robot.line = root->GetLineNum();
  robot.name = root->Attribute("name") == nullptr ? "robot" : root->Attribute("name");
  for (const XMLElement* at = root->FirstChildElement(); at != nullptr; at = at->NextSiblingElement()) {
    const std::string_view name = at->Name();
    if (name == "link") {
      robot.links.push_back(reader.link(*at));
      check_names(reader, *at, robot.links, "link");
    } else if (name == "joint") {
      robot.joints.push_back(reader.joint(*at));
      check_names(reader, *at, robot.joints, "joint");
    } else if (name == "stillcut") {
      static const std::array<std::string, 1> kKnown{"tool_link"};
      reader.check_own(*at, kKnown);
      robot.tool_link = reader.text(*at, "tool_link");
      robot.tool_line = at->GetLineNum();
    } else if (name.starts_with("xacro:")) {
      reader.fail(*at, "is still xacro; expand it first: xacro FILE.xacro > FILE.urdf");
    }
  }
  for (const XMLElement* at = root->FirstChildElement("gazebo"); at != nullptr; at = at->NextSiblingElement("gazebo"))
    reader.spring(*at, robot.joints);
  return robot;
}

}  // namespace stillcut
