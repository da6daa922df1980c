#pragma once

#include <string>
#include <string_view>

namespace deltadyn {

/// Makes gnuplot's SVG fit to stand in a page with others: own ids, one font for all, scaled to the page, no ballast.
/// \param name  what a screen reader says
/// \throws Error if \p svg is not well-formed
std::string tidy_svg(const std::string& svg, std::string_view id_prefix, const std::string& name);

}  // namespace deltadyn
