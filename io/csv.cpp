#include "saltus/io/csv.hpp"

#include <charconv>
#include <ostream>

namespace saltus {
namespace {

constexpr std::string_view line_end = "\r\n";  // of RFC 4180

// A field is quoted where it holds what separates fields or lines; quotes in it are doubled.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string title(const std::string& name, std::string_view unit) {
  return field(name + " [" + std::string(unit) + "]");
}

std::string numbered(std::string_view name, int k) { return std::string(name) + std::to_string(k); }

std::vector<std::string> titles(int coordinates, int freedoms, const std::vector<ContactWidth>& contacts) {
  std::vector<std::string> all;
  for (const Column& column : run_columns()) {
    if (column.width == Column::Width::one) all.push_back(title(std::string(column.name), column.unit));
    const bool of_q = column.width == Column::Width::coordinates;
    if (of_q || column.width == Column::Width::freedoms)
      for (int k = 0; k < (of_q ? coordinates : freedoms); ++k)
        all.push_back(title(numbered(column.name, k), column.unit));
    if (column.width != Column::Width::gaps && column.width != Column::Width::rows) continue;
    for (const ContactWidth& contact : contacts) {
      const int width = column.width == Column::Width::gaps ? contact.gaps : contact.rows;
      for (int k = 0; k < width; ++k)
        all.push_back(title(contact.name + "." + numbered(column.name, k), column.unit));
    }
  }
  return all;
}

template <class Value>
void print(std::string& line, Value value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  line.append(text, end);
}

}  // namespace

void write_csv_header(std::ostream& out, int coordinates, int freedoms,
                      const std::vector<ContactWidth>& contacts) {
  std::string line;
  for (const std::string& name : titles(coordinates, freedoms, contacts))
    line += (line.empty() ? "" : ",") + name;
  out << line << line_end;
}

void write_csv_header(std::ostream& out, const NonSmoothDynamicalSystem& model) {
  std::vector<ContactWidth> contacts;
  for (const auto& link : model.links())
    contacts.push_back({link.name, link.interaction->law().size(), link.interaction->law().gaps});
  write_csv_header(out, model.coordinates(), model.dimension(), contacts);
}

void write_csv_rows(std::ostream& out, const Recording& rows) {
  std::string line;
  for (long row = 0; row < rows.rows(); ++row) {
    line.clear();
    for (const Column& column : run_columns())
      std::visit(
          [&](auto member) {
            const auto& values = rows.*member;
            const long width = static_cast<long>(values.size()) / rows.rows();
            for (long k = 0; k < width; ++k) {
              if (!line.empty()) line += ',';
              print(line, values[row * width + k]);
            }
          },
          column.values);
    out << line << line_end;
  }
}

}  // namespace saltus
