#include "urdf_tree.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <console_bridge/console.h>
#include <fmt/format.h>
#include <limits>
#include <mutex>
#include <set>
#include <sstream>
#include <tinyxml2.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include "deltadyn/runtime/plausibility.hpp"

#include "robot_file_format.hpp"
#include "xml_elements.hpp"

namespace deltadyn::robot_file {
namespace {

using tinyxml2::XMLElement;

std::string at(const std::string& where, const XMLElement* element) {
  const char* name = element->Attribute("name");
  return fmt::format("{}, line {}, {}{}{}", where, element->GetLineNum(), element->Name(), name != nullptr ? " " : "",
                     name != nullptr ? name : "");
}

std::string attribute(const XMLElement* element, const char* name, const std::string& place) {
  const char* value = element->Attribute(name);
  if (value == nullptr || *value == '\0')
    refuse(fmt::format("<{}> has no attribute '{}'", element->Name(), name), place,
           fmt::format("write {}=\"...\"", name));
  return value;
}

const XMLElement* require_child(const XMLElement* element, const char* name, const std::string& place) {
  const XMLElement* child = element->FirstChildElement(name);
  if (child == nullptr)
    refuse(fmt::format("<{}> has no element <{}>", element->Name(), name), place, fmt::format("add <{}>", name));
  return child;
}

Eigen::Vector3d parse_vector(const std::string& text, const std::string& where, const std::string& name) {
  std::istringstream words(text);
  std::string word;
  Eigen::Vector3d v;
  int count = 0;
  for (; words >> word; ++count) {
    if (count == 3) break;
    v(count) = parse_number(word, where, name);
  }
  if (count != 3 || words >> word)
    refuse(fmt::format("attribute {} is '{}', but must be three numbers", name, text), where,
           "separate them by blanks");
  return v;
}

/// URDF: fixed axes, roll then pitch then yaw.
Pose pose_of(const Eigen::Vector3d& xyz, const Eigen::Vector3d& rpy) {
  using Eigen::AngleAxisd;
  Pose X = Pose::Identity();
  X.linear() = (AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  X.translation() = xyz;
  return X;
}

LoopEnd loop_end(const XMLElement* loop, const char* side, const std::string& where) {
  const std::string place = at(where, loop);
  const XMLElement* element = require_child(loop, side, place);
  LoopEnd end;
  end.link = attribute(element, "link", place);
  if (const XMLElement* origin = element->FirstChildElement("origin")) {
    const char* xyz = origin->Attribute("xyz");
    const char* rpy = origin->Attribute("rpy");
    end.X_LO = pose_of(xyz != nullptr ? parse_vector(xyz, place, "xyz") : Eigen::Vector3d::Zero(),
                       rpy != nullptr ? parse_vector(rpy, place, "rpy") : Eigen::Vector3d::Zero());
  }
  return end;
}

/// What plain XML can tell before urdfdom builds the tree: its own messages do not say the line.
struct XmlFacts {
  std::map<std::string, int> link_lines, joint_lines;
};

XmlFacts check_xml(const XMLElement* robot, const std::string& where) {
  XmlFacts facts;
  for (auto* link = robot->FirstChildElement("link"); link != nullptr; link = link->NextSiblingElement("link")) {
    const auto [other, is_new] = facts.link_lines.emplace(attribute(link, "name", at(where, link)), link->GetLineNum());
    if (!is_new)
      refuse(fmt::format("there is a link of this name on line {} already", other->second), at(where, link),
             "rename one of them");
  }
  if (facts.link_lines.empty())
    refuse("the robot has no link", where, "give a URDF robot file, e.g. one of delta-model create");
  std::map<std::string, std::string> parent_joint;
  for (auto* joint = robot->FirstChildElement("joint"); joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    const std::string place = at(where, joint);
    const std::string name = attribute(joint, "name", place);
    if (!facts.joint_lines.emplace(name, joint->GetLineNum()).second)
      refuse("there are two joints of this name", place, "rename one of them");
    for (const char* once : {"origin", "axis", "limit", "mimic", "dynamics", "parent", "child"}) {
      const XMLElement* first = joint->FirstChildElement(once);
      if (first != nullptr && first->NextSiblingElement(once) != nullptr)
        refuse(fmt::format("the joint has two <{}>", once),
               at(where, first->NextSiblingElement(once)) + ", joint " + name, "remove one of the two");
    }
    for (const char* side : {"parent", "child"}) {
      const std::string link = attribute(require_child(joint, side, place), "link", place);
      if (facts.link_lines.count(link) == 0)
        refuse(fmt::format("unknown {} link '{}'", side, link), place,
               fmt::format("add <link name=\"{}\"/> or mend the name", link));
      if (std::string(side) == "child") {
        const auto [other, is_new] = parent_joint.emplace(link, name);
        if (!is_new)
          refuse(fmt::format("link '{}' already hangs on joint '{}'", link, other->second), place,
                 "a link has one parent in URDF; close the loop by a <loop> element");
      }
    }
  }
  return facts;
}

/// Links that hang below each link, itself included.
int size_below(const std::string& link, const std::map<std::string, std::vector<std::string>>& children,
               int depth = 0) {
  int size = 1;
  const auto found = children.find(link);
  if (found == children.end() || depth > 1000) return size;
  for (const std::string& child : found->second) size += size_below(child, children, depth + 1);
  return size;
}

/// What urdfdom asks for and CAD programs leave out: limits of joints, and one root.
std::string completed(tinyxml2::XMLDocument& document, XMLElement* robot, XmlFacts& facts) {
  std::map<std::string, std::vector<std::string>> children;
  std::set<std::string> hung;
  for (auto* joint = robot->FirstChildElement("joint"); joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    const std::string child = joint->FirstChildElement("child")->Attribute("link");
    children[joint->FirstChildElement("parent")->Attribute("link")].push_back(child);
    hung.insert(child);
    const char* type = joint->Attribute("type");
    const bool limited = type != nullptr && (std::string(type) == "revolute" || std::string(type) == "prismatic");
    if (!limited || joint->FirstChildElement("limit") != nullptr) continue;
    const std::string most = text(kUnlimited);
    xml::child(joint, "limit", {{"lower", "-" + most}, {"upper", most}, {"effort", most}, {"velocity", most}});
  }
  std::vector<std::string> roots;
  for (const auto& [link, line] : facts.link_lines)
    if (hung.count(link) == 0) roots.push_back(link);
  const auto size = [&](const std::string& link) { return size_below(link, children); };
  if (!roots.empty()) std::swap(roots.front(), *std::ranges::max_element(roots, {}, size));
  for (std::size_t k = 1; k < roots.size(); ++k) {
    const std::string name = "loose_" + roots[k];
    XMLElement* joint = xml::child(robot, "joint", {{"name", name}, {"type", "floating"}});
    xml::child(joint, "parent", {{"link", roots.front()}});
    xml::child(joint, "child", {{"link", roots[k]}});
    facts.joint_lines.emplace(name, facts.link_lines.at(roots[k]));
  }
  return xml::text_of(document);
}

/// urdfdom reports through console_bridge; this keeps its words for our message and off the terminal.
class CapturedMessages : public console_bridge::OutputHandler {
 public:
  CapturedMessages() : previous_(console_bridge::getOutputHandler()) { console_bridge::useOutputHandler(this); }
  CapturedMessages(const CapturedMessages&) = delete;
  CapturedMessages& operator=(const CapturedMessages&) = delete;
  ~CapturedMessages() override { console_bridge::useOutputHandler(previous_); }
  void log(const std::string& words, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) text_ += (text_.empty() ? "" : "; ") + words;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  console_bridge::OutputHandler* previous_;
  std::string text_;
};

urdf::ModelInterfaceSharedPtr parse_model(const std::string& text, const std::string& where) {
  static std::mutex one_at_a_time;  // console_bridge has one handler for the whole process
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  CapturedMessages messages;
  urdf::ModelInterfaceSharedPtr model;
  std::string thrown;
  try {
    model = urdf::parseURDF(text);
  } catch (const std::exception& e) {  // e.g. two root links
    thrown = e.what();
  }
  if (!model || !model->getRoot())
    refuse("not a valid URDF tree: " + (messages.text().empty() ? thrown : messages.text()), where,
           "mend the named element");
  return model;
}

Pose pose_of(const urdf::Pose& pose) {
  Pose X = Pose::Identity();
  const auto& q = pose.rotation;
  X.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  X.translation() = Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z);
  return X;
}

double unlimited_as_infinite(double limit) {
  return std::abs(limit) >= kUnlimited ? std::copysign(std::numeric_limits<double>::infinity(), limit) : limit;
}

DriveLimits limits_of(const urdf::Joint& joint) {
  DriveLimits limits;
  if (!joint.limits) return limits;
  if (joint.type != urdf::Joint::CONTINUOUS) {
    limits.lower = unlimited_as_infinite(joint.limits->lower);
    limits.upper = unlimited_as_infinite(joint.limits->upper);
  }
  limits.effort = unlimited_as_infinite(joint.limits->effort);
  limits.velocity = unlimited_as_infinite(joint.limits->velocity);
  return limits;
}

void read_inertial(const urdf::Link& link, UrdfTree& tree) {
  if (!link.inertial) return;
  const urdf::Inertial& from = *link.inertial;
  LinkInertial to;
  to.mass = from.mass;
  to.X_LC = pose_of(from.origin);
  to.I_C << from.ixx, from.ixy, from.ixz, from.ixy, from.iyy, from.iyz, from.ixz, from.iyz, from.izz;
  if (!std::isfinite(to.mass) || !to.I_C.allFinite() || !to.X_LC.matrix().allFinite())
    refuse("the <inertial> holds a number that is not finite", tree.at(link.name),
           "give finite numbers, or leave <inertial> out");
  tree.inertials[link.name] = to;
}

/// Walks down from a link whose place is known.
void add_children(const urdf::Link& link, const XmlFacts& facts, UrdfDialect dialect, UrdfTree& tree) {
  const LinkPlace here = tree.links.at(link.name);
  read_inertial(link, tree);
  for (const auto& joint : link.child_joints) {
    const auto found = std::ranges::find(link.child_links, joint->child_link_name, &urdf::Link::name);
    if (found == link.child_links.end())
      refuse(fmt::format("joint '{}' leads nowhere", joint->name), tree.where, "mend the child of the joint");
    const urdf::LinkSharedPtr& child = *found;
    const Pose X_BJ = here.X_BL * pose_of(joint->parent_to_joint_origin_transform);
    if (joint->type == urdf::Joint::FIXED) {
      tree.links[child->name] = {here.body, X_BJ, link.name};
      tree.bodies[static_cast<std::size_t>(here.body)].links.push_back(child->name);
    } else {
      const int body = static_cast<int>(tree.bodies.size());
      const Eigen::Vector3d axis(joint->axis.x, joint->axis.y, joint->axis.z);
      const Joint moving{.name = joint->name,
                         .line = facts.joint_lines.at(joint->name),
                         .parent_link = link.name,
                         .prismatic = joint->type == urdf::Joint::PRISMATIC,
                         .parent = here.body,
                         .child = body,
                         .X_PJ = X_BJ,
                         // A unit vector stays as written, to the last digit.
                         .axis = std::abs(axis.norm() - 1) < 1e-15 ? axis : Eigen::Vector3d(axis.normalized()),
                         .mimics = joint->mimic ? joint->mimic->joint_name : std::string(),
                         .mimic_gain = joint->mimic ? joint->mimic->multiplier : 0.0,
                         .mimic_offset = joint->mimic ? joint->mimic->offset : 0.0,
                         .floating = joint->type == urdf::Joint::FLOATING || joint->type == urdf::Joint::PLANAR,
                         .limits = limits_of(*joint)};
      if (!(moving.floating && dialect == UrdfDialect::cad) && !moving.prismatic &&
          joint->type != urdf::Joint::REVOLUTE && joint->type != urdf::Joint::CONTINUOUS)
        refuse("the joint is neither revolute, continuous, prismatic nor fixed", tree.at(moving),
               "a Delta's tree has no other joints");
      if (!moving.floating && !(axis.norm() > 1e-9))
        refuse("the axis has no direction", tree.at(moving), "write a unit vector");
      tree.bodies[static_cast<std::size_t>(here.body)].joints.push_back(static_cast<int>(tree.joints.size()));
      tree.joints.push_back(moving);
      tree.bodies.push_back({child->name, {}, {child->name}});
      tree.links[child->name] = {body, Pose::Identity(), {}};
    }
    add_children(*child, facts, dialect, tree);
  }
}

/// A word of ours that is misspelt or stands twice would be passed over, and what it says be lost.
void check_extension(const XMLElement* robot, const std::string& where) {
  const XMLElement* extension = nullptr;
  for (auto* element = robot->FirstChildElement(); element != nullptr; element = element->NextSiblingElement()) {
    const std::string name = element->Name();
    if (name == "deltadyn") {
      if (extension != nullptr)
        refuse(fmt::format("<deltadyn> stands on line {} already", extension->GetLineNum()), at(where, element),
               "remove one of the two");
      extension = element;
    } else if (name.starts_with("delta") || name.starts_with("Delta")) {
      refuse(fmt::format("<{}> is not known", name), at(where, element), "write <deltadyn>");
    }
  }
  if (extension == nullptr) return;
  std::map<std::string, int> lines;
  for (auto* element = extension->FirstChildElement(); element != nullptr; element = element->NextSiblingElement()) {
    const std::string name = element->Name();
    if (name != "gravity" && name != "plate" && name != "drive")
      refuse(fmt::format("<{}> in <deltadyn> is not known", name), at(where, element),
             "known are <gravity>, <plate> and <drive>");
    const char* joint = element->Attribute("joint");
    const std::string key = name == "drive" && joint != nullptr ? fmt::format("drive joint=\"{}\"", joint) : name;
    const auto [first, is_new] = lines.emplace(key, element->GetLineNum());
    if (!is_new)
      refuse(fmt::format("<{}> stands on line {} already", key, first->second), at(where, element),
             "remove one of the two");
  }
}

void read_extension(const XMLElement* robot, UrdfTree& tree) {
  check_extension(robot, tree.where);
  const XMLElement* extension = robot->FirstChildElement("deltadyn");
  if (extension == nullptr) return;
  tree.extension_line = extension->GetLineNum();
  const std::string place = at(tree.where, extension);
  if (const char* version = extension->Attribute("version"); version != nullptr && std::string(version) != "1")
    refuse(fmt::format("version {} of <deltadyn> is not known", version), place, "use a newer deltadyn");
  if (const char* type = extension->Attribute("type")) tree.declared_type = type;
  if (const XMLElement* gravity = extension->FirstChildElement("gravity")) {
    const std::string there = at(tree.where, gravity);
    for (auto* entry = gravity->FirstAttribute(); entry != nullptr; entry = entry->Next())
      if (std::string_view(entry->Name()) != "xyz_m_s2")
        refuse(fmt::format("attribute '{}' is not known", entry->Name()), there, "known is xyz_m_s2");
    tree.gravity = parse_vector(attribute(gravity, "xyz_m_s2", there), there, "xyz_m_s2");
  }
  if (const XMLElement* plate = extension->FirstChildElement("plate")) {
    tree.plate.line = plate->GetLineNum();
    for (auto* entry = plate->FirstAttribute(); entry != nullptr; entry = entry->Next())
      tree.plate.attributes[entry->Name()] = entry->Value();
  }
  for (auto* drive = extension->FirstChildElement("drive"); drive != nullptr;
       drive = drive->NextSiblingElement("drive")) {
    DriveNote& note = tree.drives.emplace_back();
    note.line = drive->GetLineNum();
    for (auto* entry = drive->FirstAttribute(); entry != nullptr; entry = entry->Next())
      (std::string_view(entry->Name()) == "joint" ? note.joint : note.attributes[entry->Name()]) = entry->Value();
  }
}

void read_loops(const XMLElement* robot, UrdfDialect dialect, UrdfTree& tree) {
  for (auto* element = robot->FirstChildElement("loop"); element != nullptr;
       element = element->NextSiblingElement("loop")) {
    const std::string place = at(tree.where, element);
    Loop& loop = tree.loops.emplace_back();
    loop.name = attribute(element, "name", place);
    loop.type = attribute(element, "type", place);
    loop.line = element->GetLineNum();
    loop.predecessor = loop_end(element, "predecessor", tree.where);
    loop.successor = loop_end(element, "successor", tree.where);
    for (const LoopEnd* end : {&loop.predecessor, &loop.successor})
      if (tree.links.count(end->link) == 0)
        refuse(fmt::format("unknown link '{}'", end->link), place, "mend the name of the link");
    if (const XMLElement* axis = element->FirstChildElement("axis"))
      loop.axis = parse_vector(attribute(axis, "xyz", place), place, "xyz").normalized();
  }
  if (auto* coupling = robot->FirstChildElement("coupling"); coupling != nullptr && dialect == UrdfDialect::robot_file)
    refuse("a <coupling> ties two joints, which no robot of a known type has", at(tree.where, coupling),
           "remove the coupling, the loops hold the plate already");
}

}  // namespace

void refuse(const std::string& what, const std::string& where, const std::string& mend, ExitCode code) {
  throw Error(what, where, mend, code);
}

std::string UrdfTree::at(const Joint& joint) const {
  return fmt::format("{}, line {}, joint {}", where, joint.line, joint.name);
}
std::string UrdfTree::at(const Loop& loop) const {
  return fmt::format("{}, line {}, loop {}", where, loop.line, loop.name);
}
std::string UrdfTree::at(const std::string& link) const {
  return fmt::format("{}, link {}", where, link);
}

InertialVector<double> LinkInertial::in_frame(const Pose& X_FL) const {
  const Pose X_FC = X_FL * X_LC;
  const Eigen::Vector3d c = X_FC.translation();
  const Eigen::Matrix3d I = X_FC.linear() * I_C * X_FC.linear().transpose() +
                            mass * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
  InertialVector<double> p;
  p << mass, mass * c, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(1, 2), I(0, 2);
  return p;
}

LinkInertial central_inertial(const InertialVector<double>& p) {
  using namespace inertial;
  const Eigen::Vector3d c = p.segment<3>(kMcx) / p(kM);
  LinkInertial out{.mass = p(kM)};
  out.X_LC.translation() = c;
  out.I_C << p(kIxx), p(kIxy), p(kIxz), p(kIxy), p(kIyy), p(kIyz), p(kIxz), p(kIyz), p(kIzz);
  out.I_C -= p(kM) * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
  return out;
}

double parse_number(const std::string& text, const std::string& where, const std::string& attribute_name) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;  // from_chars does not take a leading plus
  double value = 0;
  const auto [stop, code] = std::from_chars(begin, end, value);
  if (code != std::errc() || stop != end || !std::isfinite(value))
    refuse(fmt::format("attribute {} holds '{}', which is not a finite number", attribute_name, text), where,
           "write a decimal number");
  return value;
}

void require_metres(const UrdfTree& tree) {
  const auto check = [&tree](const Eigen::Vector3d& origin, const std::string& place) {
    try {
      plausibility::require(plausibility::kOffset, origin.norm(), "its distance from the link's origin", place);
    } catch (const Error& e) {
      const bool has_plate = tree.plate.line > 0;  // which delta-model adopt does not take
      refuse(
          e.problem(), place,
          e.mend() + (has_plate ? std::string("; a file in millimetres throughout is made anew by delta-model create")
                                : fmt::format("; a file in millimetres throughout is turned by delta-model adopt {} "
                                              "--length-unit mm -o robot.urdf",
                                              tree.where)));
    }
  };
  for (const Joint& joint : tree.joints)
    check((tree.links.at(joint.parent_link).X_BL.inverse() * joint.X_PJ).translation(), tree.at(joint));
  for (const Loop& loop : tree.loops)
    for (const LoopEnd* end : {&loop.predecessor, &loop.successor}) check(end->X_LO.translation(), tree.at(loop));
}

UrdfTree parse_urdf_tree(const std::string& text, const std::string& where, UrdfDialect dialect) {
  tinyxml2::XMLDocument document;
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    refuse("the file is empty", where, "give a URDF robot file, e.g. one of delta-model create");
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    refuse(fmt::format("not well-formed XML ({})", document.ErrorName()),
           fmt::format("{}, line {}", where, document.ErrorLineNum()),
           "give a URDF robot file, e.g. one of delta-model create");
  XMLElement* robot = document.RootElement();
  if (robot == nullptr || std::string(robot->Name()) != "robot")
    refuse(
        fmt::format("the root element is <{}>, but a URDF starts with <robot>", robot == nullptr ? "" : robot->Name()),
        where, "give a URDF robot file, e.g. one of delta-model create");
  XmlFacts facts = check_xml(robot, where);
  const bool cad = dialect == UrdfDialect::cad;
  const urdf::ModelInterfaceSharedPtr model = parse_model(cad ? completed(document, robot, facts) : text, where);

  UrdfTree tree;
  tree.name = model->getName();
  tree.where = where;
  const auto root = model->getRoot();
  tree.bodies.push_back({root->name, {}, {root->name}});
  tree.links[root->name] = {0, Pose::Identity(), {}};
  add_children(*root, facts, dialect, tree);
  read_loops(robot, dialect, tree);
  read_extension(robot, tree);
  return tree;
}

}  // namespace deltadyn::robot_file
