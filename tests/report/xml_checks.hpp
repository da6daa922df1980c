#pragma once

/// \file
/// What the tests of the report look up in pages and pictures.

#include <functional>
#include <gtest/gtest.h>
#include <string>
#include <tinyxml2.h>
#include <vector>

namespace deltadyn::testing_support {

/// Visits all elements. A document that is not well-formed is a failure of the test.
inline void for_each_element(const std::string& xml, const std::function<void(const tinyxml2::XMLElement&)>& visit) {
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(xml.data(), xml.size()), tinyxml2::XML_SUCCESS) << document.ErrorStr();
  const std::function<void(const tinyxml2::XMLElement&)> walk = [&](const tinyxml2::XMLElement& element) {
    visit(element);
    for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
      walk(*child);
  };
  ASSERT_NE(document.RootElement(), nullptr);
  walk(*document.RootElement());
}

inline std::string text_of(const tinyxml2::XMLNode& node) {
  if (const auto* text = node.ToText()) return text->Value();
  std::string result;
  for (const auto* child = node.FirstChild(); child != nullptr; child = child->NextSibling()) result += text_of(*child);
  return result;
}

/// Texts of all elements of that name, with entities resolved.
inline std::vector<std::string> texts(const std::string& xml, const std::string& name) {
  std::vector<std::string> result;
  for_each_element(xml, [&](const auto& element) {
    if (element.Name() == name) result.push_back(text_of(element));
  });
  return result;
}

/// Values of an attribute wherever it occurs.
inline std::vector<std::string> attributes(const std::string& xml, const std::string& attribute) {
  std::vector<std::string> result;
  for_each_element(xml, [&](const auto& element) {
    if (const char* value = element.Attribute(attribute.c_str())) result.emplace_back(value);
  });
  return result;
}

}  // namespace deltadyn::testing_support
