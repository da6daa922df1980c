#pragma once

/// \file
/// Elements of XML files, for those who write them.

#include <initializer_list>
#include <string>
#include <tinyxml2.h>
#include <utility>

namespace deltadyn::xml {

using tinyxml2::XMLElement;
using Attributes = std::initializer_list<std::pair<const char*, std::string>>;

inline void set(XMLElement* element, const Attributes& attributes) {
  for (const auto& [name, value] : attributes) element->SetAttribute(name, value.c_str());
}

/// Adds an element behind the others of its parent.
inline XMLElement* child(tinyxml2::XMLNode* parent, const char* name, const Attributes& attributes = {}) {
  XMLElement* element = parent->GetDocument()->NewElement(name);
  parent->InsertEndChild(element);
  set(element, attributes);
  return element;
}

inline std::string text_of(const tinyxml2::XMLDocument& document) {
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace deltadyn::xml
