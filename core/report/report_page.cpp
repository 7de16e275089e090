#include "core/report/report_page.h"

#include <openssl/evp.h>

#include "core/base/files.h"

namespace rimlight {
namespace {

constexpr std::size_t kLargestPicture = 16 << 20;

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --line: #8884; --quiet: #777; }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.8rem; } h2 { margin-top: 3rem; border-top: 1px solid var(--line); padding-top: 1rem; }
nav ul, dl { columns: 2; } dt { color: var(--quiet); break-after: avoid; } dd { margin: 0 0 .4rem; overflow-wrap: anywhere; }
div.table { overflow-x: auto; }
table { border-collapse: collapse; margin: 1rem 0; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: var(--quiet); padding-bottom: .3rem; }
th, td { padding: .15rem .7rem; border-bottom: 1px solid var(--line); text-align: left; white-space: nowrap; }
th.number, td.number { text-align: right; }
figure { margin: 1rem 0; } img { max-width: 100%; background: white; }
figcaption, p.remark { color: var(--quiet); }
)";

std::string to_base64(const std::string& bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // and the 0 that OpenSSL adds
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                   reinterpret_cast<const unsigned char*>(bytes.data()),
                                   static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

std::string element(const std::string& name, const std::string& text) {
  return "<" + name + ">" + escape_html(text) + "</" + name + ">\n";
}

std::string table_row(const Table& table, const std::vector<std::string>& cells,
                      const std::string& name) {
  std::string html = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    html += "<" + name + (is_numeric(table, i) ? " class=\"number\">" : ">") +
            escape_html(cells[i]) + "</" + name + ">";
  }
  return html + "</tr>\n";
}

std::string table_html(const Table& table) {
  std::string html = "<div class=\"table\"><table>\n" + element("caption", table.caption) +
                     "<thead>" + table_row(table, table.columns, "th") + "</thead><tbody>\n";
  for (const auto& row : table.rows) html += table_row(table, row, "td");
  return html + "</tbody></table></div>\n";
}

std::string figure_html(const std::filesystem::path& picture) {
  const std::string name = picture.stem().string();
  return "<figure><img alt=\"" + escape_html(name) + "\" src=\"data:image/png;base64," +
         to_base64(read_file(picture, kLargestPicture)) + "\">" + element("figcaption", name) +
         "</figure>\n";
}

std::string section_html(const ReportSection& section, std::size_t number) {
  std::string html = "<section id=\"s" + std::to_string(number) + "\">\n" +
                     element("h2", section.title) + element("p", section.question);
  for (const std::string& remark : section.remarks) {
    html += "<p class=\"remark\">" + escape_html(remark) + "</p>\n";
  }
  for (const Table& table : section.tables) html += table_html(table);
  for (const auto& picture : section.pictures) html += figure_html(picture);
  return html + "</section>\n";
}

}  // namespace

std::string escape_html(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string to_html(const std::string& title,
                    const std::vector<std::pair<std::string, std::string>>& facts,
                    const std::vector<ReportSection>& sections) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
      "name=\"viewport\" content=\"width=device-width\">\n" +
      element("title", title) + "<style>" + kStyle + "</style>\n</head>\n<body>\n" +
      element("h1", title) + "<dl>\n";
  for (const auto& [name, text] : facts) html += element("dt", name) + element("dd", text);
  html += "</dl>\n<nav><ul>\n";
  for (std::size_t i = 0; i < sections.size(); ++i) {
    html += "<li><a href=\"#s" + std::to_string(i) + "\">" + escape_html(sections[i].title) +
            "</a></li>\n";
  }
  html += "</ul></nav>\n";
  for (std::size_t i = 0; i < sections.size(); ++i) html += section_html(sections[i], i);
  return html + "</body>\n</html>\n";
}

}  // namespace rimlight
