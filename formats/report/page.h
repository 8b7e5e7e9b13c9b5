// SPDX-License-Identifier: Apache-2.0
/// Self-contained HTML pages: everything embedded, nothing fetched. Every command that reports
/// writes its page here.
#pragma once

#include <string>
#include <vector>

namespace nearfield::report {

/// A picture that the page carries within itself.
struct Image {
    std::string media_type;  // "image/png" or "image/svg+xml"
    std::string bytes;       // the file's content
    std::string caption;     // also the text for those who do not see it
};

struct Table {
    std::string caption;
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;  // as many cells as columns
};

/// One headed part of a page; its contents come in this order.
struct Section {
    std::string title;
    std::vector<std::string> paragraphs;  // plain text; everything is escaped
    std::vector<Image> images;
    std::vector<Table> tables;
    std::string preformatted;  // a command, a machine; empty: none
    int columns = 1;           // of images, as far as the window is wide enough
};

struct Page {
    std::string title;
    std::string summary;  // one sentence under the title
    std::vector<Section> sections;
};

/// A PNG (or by its ending, SVG) file as an image. Throws Error if it cannot be read.
Image read_image(const std::string& path, const std::string& caption);

/// The page as HTML5 text without scripts.
std::string to_html(const Page& page);

/// Writes it, whole or not at all.
void write_page(const Page& page, const std::string& path);

}  // namespace nearfield::report
