#include "svg_tidy.hpp"

#include <string>
#include <string_view>
#include <tinyxml2.h>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

using tinyxml2::XMLElement;

constexpr const char* kFonts = "Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

std::string without_extra_spaces(std::string_view path) {
  std::string result;
  for (const char c : path) {
    const bool space = c == ' ' || c == '\t' || c == '\n' || c == '\r';
    if (!space)
      result += c;
    else if (!result.empty() && result.back() != ' ')
      result += ' ';
  }
  while (!result.empty() && result.back() == ' ') result.pop_back();
  return result;
}

void rename(XMLElement& element, const char* attribute, const std::string& prefix) {
  if (const char* id = element.Attribute(attribute)) element.SetAttribute(attribute, (prefix + id).c_str());
}

void tidy(XMLElement& element, const std::string& prefix) {
  rename(element, "id", prefix);
  if (const char* link = element.Attribute("xlink:href"); link != nullptr && link[0] == '#') {
    const std::string target = "#" + prefix + (link + 1);
    element.SetAttribute("xlink:href", target.c_str());
  }
  for (const char* attribute : {"fill", "clip-path", "filter", "mask"}) {
    const std::string value = element.Attribute(attribute) == nullptr ? "" : element.Attribute(attribute);
    if (value.rfind("url(#", 0) == 0) element.SetAttribute(attribute, ("url(#" + prefix + value.substr(5)).c_str());
  }
  // One font for the whole picture; gnuplot writes its weight as a part of the name, which no browser knows.
  if (const char* font = element.Attribute("font-family"); font != nullptr) {
    if (std::string_view(font).find(":Bold") != std::string_view::npos) element.SetAttribute("font-weight", "bold");
    element.DeleteAttribute("font-family");
  }
  if (const char* path = element.Attribute("d")) element.SetAttribute("d", without_extra_spaces(path).c_str());

  for (XMLElement* child = element.FirstChildElement(); child != nullptr;) {
    XMLElement* next = child->NextSiblingElement();
    tidy(*child, prefix);
    const std::string name = child->Name();
    // The names of curves would pop up as tool tips wherever the mouse rests; the legend says them already.
    if ((name == "g" && child->NoChildren()) || name == "title" || name == "desc") element.DeleteChild(child);
    child = next;
  }
}

}  // namespace

std::string tidy_svg(const std::string& svg, std::string_view id_prefix, const std::string& name) {
  tinyxml2::XMLDocument document;
  if (document.Parse(svg.data(), svg.size()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr) {
    throw Error("gnuplot wrote a picture that cannot be read: " + std::string(document.ErrorStr()),
                "plot \"" + name + "\"", "install gnuplot-nox 5.4 or later", ExitCode::bad_input);
  }
  XMLElement& root = *document.RootElement();
  tidy(root, std::string(id_prefix));
  root.DeleteAttribute("height");
  root.SetAttribute("width", "100%");
  root.SetAttribute("role", "img");
  root.SetAttribute("font-family", kFonts);
  if (!name.empty()) root.SetAttribute("aria-label", name.c_str());
  tinyxml2::XMLPrinter printer(nullptr, true);
  root.Accept(&printer);
  return printer.CStr();
}

}  // namespace deltadyn
