#include "tools/report_html.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>

namespace stillcut::html {
namespace {

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t j = 0; j < 3; ++j)
      three = three << 8U | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j) text += i + j <= bytes.size() ? kDigits[three >> (18 - 6 * j) & 0x3FU] : '=';
  }
  return text;
}

// A cell of digits and what goes with them, or a dash alone, is a number.
bool is_number(const std::string& text) {
  return text == "–" || (!text.empty() && text.find("→") == std::string::npos &&
                         std::none_of(text.begin(), text.end(), [](unsigned char c) { return std::isalpha(c) != 0; }));
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 0x20 ? '?' : c;  // no control characters in XML
    }
  }
  return result;
}

std::string picture(const plot::Figure& figure, plot::Format format, const std::string& alt) {
  const bool png = format == plot::Format::png;
  std::string text = "<img alt=\"";
  text.append(escaped(alt)).append("\" width=\"").append(std::to_string(figure.width)).append("\" src=\"data:image/");
  text.append(png ? "png" : "svg+xml").append(";base64,");
  return text.append(base64(plot::figure_bytes(figure, format))).append("\"/>\n");
}

std::string table(const Table& table) {
  std::vector<bool> numbers(table.header.size(), !table.rows.empty());
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = numbers[i] && is_number(row.at(i));
  const auto cell = [&](const char* tag, std::size_t i, const std::string& text) {
    std::string result(1, '<');
    result.append(tag).append(numbers[i] ? " class=\"n\">" : ">").append(escaped(text));
    return result.append("</").append(tag).append(">");
  };
  std::string text = "<div class=\"wide\"><table>\n<thead><tr>";
  for (std::size_t i = 0; i < table.header.size(); ++i) text += cell("th", i, table.header[i]);
  text += "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    text += r < table.row_class.size() && !table.row_class[r].empty() ? "<tr class=\"" + table.row_class[r] + "\">"
                                                                      : "<tr>";
    for (std::size_t i = 0; i < table.header.size(); ++i) text += cell("td", i, table.rows[r][i]);
    text += "</tr>\n";
  }
  return text += "</tbody>\n</table></div>\n";
}

std::string facts(std::initializer_list<std::pair<const char*, std::string>> pairs) {
  std::string text = "<dl>\n";
  for (const auto& [name, value] : pairs) {
    if (value.empty()) continue;
    text.append("<div><dt>").append(escaped(name)).append("</dt><dd>").append(escaped(value)).append("</dd></div>\n");
  }
  return text += "</dl>\n";
}

const char* style_sheet() {
  return R"(
:root { --ink: #1d2129; --soft: #5b6472; --page: #f4f5f7; --card: #ffffff; --line: #dfe3e8;
  --good: #00795a; --notable: #9a6700; --bad: #b3400b; --good-page: #e6f4ef; --notable-page: #fdf3dc; --bad-page: #fdeae1; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e9ee; --soft: #a2abb8; --page: #14171c; --card: #1d2229; --line: #343b46;
    --good: #4fc9a0; --notable: #e8b34a; --bad: #f2875a; --good-page: #15302a; --notable-page: #352a12; --bad-page: #3a1f14; }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 1120px; margin: 0 auto; padding: 28px 20px 60px; }
h1 { font-size: 26px; line-height: 1.2; margin: 0 0 4px; }
h2 { font-size: 19px; margin: 36px 0 10px; }
h3 { font-size: 16px; margin: 0 0 6px; }
p { margin: 6px 0; max-width: 80ch; }
.soft, caption { color: var(--soft); }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 16px 18px; margin: 12px 0; }
.verdict { font-size: 18px; border-left: 6px solid; }
.verdict p { max-width: none; margin: 0; }
.good { border-left-color: var(--good); background: var(--good-page); }
.notable { border-left-color: var(--notable); background: var(--notable-page); }
.bad { border-left-color: var(--bad); background: var(--bad-page); }
dl { display: flex; flex-wrap: wrap; gap: 10px 28px; margin: 8px 0; }
dt { color: var(--soft); font-size: 12.5px; }
dd { margin: 0; font-variant-numeric: tabular-nums; }
img { display: block; width: 100%; height: auto; background: #ffffff; border-radius: 6px; margin: 10px 0 6px; }
.wide { overflow-x: auto; margin: 8px -9px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: 14px; }
th { text-align: left; font-weight: 600; color: var(--soft); border-bottom: 2px solid var(--line); padding: 5px 9px;
  vertical-align: bottom; }
td { border-bottom: 1px solid var(--line); padding: 5px 9px; vertical-align: top; }
.n { text-align: right; white-space: nowrap; }
tr.chatter td { color: var(--bad); font-weight: 600; }
footer { margin-top: 40px; color: var(--soft); font-size: 13px; border-top: 1px solid var(--line); padding-top: 12px; }
@media print {
  :root { --ink: #000; --soft: #444; --page: #fff; --card: #fff; --line: #bbb; }
  body { font-size: 11px; }
  main { max-width: none; padding: 0; }
  .card { break-inside: avoid; }
  h2 { break-after: avoid; }
}
)";
}

}  // namespace stillcut::html
