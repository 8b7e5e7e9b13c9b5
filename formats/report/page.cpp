// SPDX-License-Identifier: Apache-2.0
#include "formats/report/page.h"

#include "formats/files/atomic_file.h"
#include "formats/files/error.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string_view>

namespace nearfield::report {
namespace {

constexpr std::string_view kStyle =
    "body{font:16px/1.5 sans-serif;max-width:70rem;margin:2rem auto;padding:0 1rem;color:#222;"
    "background:#fff}"
    "h1{margin-bottom:0}h2{margin-top:2.5rem;border-bottom:1px solid #ccc}"
    "img{max-width:100%;height:auto}figure{margin:1rem 0}figcaption{color:#555;font-size:90%}"
    "table{border-collapse:collapse;margin:1rem 0}caption{text-align:left;color:#555}"
    "td,th{border:1px solid #ccc;padding:.2rem .6rem;text-align:left;"
    "font-variant-numeric:tabular-nums}th{background:#f2f2f2}"
    ".grid{display:grid;gap:0 1rem;"
    "grid-template-columns:repeat(auto-fill,minmax(max(18rem,100%/var(--columns) - 1rem),1fr))}"
    ".scroll{overflow-x:auto}.short{white-space:nowrap}"
    "pre{background:#f2f2f2;padding:.8rem;overflow-x:auto}";

std::string escape(std::string_view text) {
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
            case '\'':
                escaped += "&#39;";
                break;
            default:
                escaped += c;
        }
    }
    return escaped;
}

// RFC 4648.
std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t at = 0; at < bytes.size(); at += 3) {
        std::uint32_t triple = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const bool is_inside = at + k < bytes.size();
            triple =
                (triple << 8U) |
                (is_inside ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + k]))
                           : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const bool is_padding = at + k > bytes.size();
            text += is_padding ? '=' : kDigits[(triple >> (18U - 6U * k)) & 63U];
        }
    }
    return text;
}

constexpr std::size_t kLongestUnbroken = 24;  // characters

std::string table_html(const Table& table) {
    std::string html =
        "<div class=\"scroll\"><table>\n<caption>" + escape(table.caption) + "</caption>\n<tr>";
    for (const std::string& column : table.columns) {
        html += "<th>" + escape(column) + "</th>";
    }
    html += "</tr>\n";
    for (const std::vector<std::string>& row : table.rows) {
        html += "<tr>";
        for (const std::string& cell : row) {
            // A number stays with its unit; a table that gets too wide scrolls.
            const bool is_short = cell.size() <= kLongestUnbroken;
            html += (is_short ? "<td class=\"short\">" : "<td>") + escape(cell) + "</td>";
        }
        html += "</tr>\n";
    }
    return html + "</table></div>\n";
}

std::string section_html(const Section& section) {
    std::string html = "<h2>" + escape(section.title) + "</h2>\n";
    for (const std::string& paragraph : section.paragraphs) {
        html += "<p>" + escape(paragraph) + "</p>\n";
    }
    if (section.columns > 1)
        html += fmt::format("<div class=\"grid\" style=\"--columns:{}\">\n", section.columns);
    for (const Image& image : section.images) {
        const std::string caption = escape(image.caption);
        html += "<figure><img alt=\"" + caption + "\" src=\"data:" + escape(image.media_type) +
                ";base64," + base64(image.bytes) + "\"><figcaption>" + caption +
                "</figcaption></figure>\n";
    }
    if (section.columns > 1)
        html += "</div>\n";
    for (const Table& table : section.tables) {
        html += table_html(table);
    }
    if (!section.preformatted.empty()) {
        html += "<pre>" + escape(section.preformatted) + "</pre>\n";
    }
    return html;
}

}  // namespace

Image read_image(const std::string& path, const std::string& caption) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream content;
    content << file.rdbuf();
    if (!file) {
        throw Error("cannot read picture", path);
    }
    return {path.ends_with(".svg") ? "image/svg+xml" : "image/png", content.str(), caption};
}

std::string to_html(const Page& page) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width\">\n<title>" +
        escape(page.title) + "</title>\n<style>" + std::string(kStyle) +
        "</style>\n</head>\n<body>\n<h1>" + escape(page.title) + "</h1>\n<p>" +
        escape(page.summary) + "</p>\n";
    for (const Section& section : page.sections) {
        html += section_html(section);
    }
    return html + "</body>\n</html>\n";
}

void write_page(const Page& page, const std::string& path) {
    write_file(to_html(page), path);
}

}  // namespace nearfield::report
