#include "saltus/siconos/scheme_name.hpp"

#include <charconv>
#include <stdexcept>

namespace saltus::siconos {
namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

OptionValue value_of(const std::string& text) {
  double number = 0.0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  if (read.ec == std::errc() && read.ptr == end) return number;
  return text;
}

}  // namespace

std::unique_ptr<saltus::OneStepIntegrator> make_scheme(const std::string& text) {
  const std::invalid_argument misread("expected an integrator as NAME or NAME(option=value, ...), got '" +
                                      text + "'");
  const std::string whole = trimmed(text);
  const auto bracket = whole.find('(');
  if (bracket == std::string::npos) return make_integrator(whole);
  if (whole.back() != ')') throw misread;
  Options options;
  const std::string inside = trimmed(whole.substr(bracket + 1, whole.size() - bracket - 2));
  for (std::size_t at = 0; at < inside.size();) {
    const auto comma = std::min(inside.find(',', at), inside.size());
    const std::string option = inside.substr(at, comma - at);
    const auto equals = option.find('=');
    if (equals == std::string::npos) throw misread;
    const std::string name = trimmed(option.substr(0, equals));
    if (!options.emplace(name, value_of(trimmed(option.substr(equals + 1)))).second) throw misread;
    at = comma + 1;
  }
  return make_integrator(trimmed(whole.substr(0, bracket)), options);
}

}  // namespace saltus::siconos
