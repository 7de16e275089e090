#pragma once

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>

namespace rimlight::server {

/// The parameters of a URL, percent-decoded, "+" a space: "a=1&b=x%20y". Throws Error for a
/// parameter that is not in `known`, twice there, or without "=", and for a "%" that no two
/// hexadecimal digits follow.
std::map<std::string, std::string> parse_query(std::string_view query,
                                               std::initializer_list<std::string_view> known);

}  // namespace rimlight::server
