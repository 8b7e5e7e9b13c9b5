// SPDX-License-Identifier: Apache-2.0
#include "formats/report/page.h"

#include "formats/files/error.h"
#include "formats/report/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace nearfield::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Page hostile_page() {
    const std::string text = "<script>alert(\"&'\")</script>";
    return {text,
            text,
            {{text,
              {text},
              {{"image/png", "\x01\x02\x03\x04", text}},
              {{text, {text}, {{text}}}},
              text}}};
}

TEST(Page, EscapesAllText) {
    // Proves that no field reaches the page as markup.
    const std::string html = to_html(hostile_page());
    EXPECT_THAT(html, Not(HasSubstr("<script")));
    EXPECT_THAT(html, HasSubstr("&lt;script&gt;alert(&quot;&amp;&#39;&quot;)&lt;/script&gt;"));
}

TEST(Page, IsSelfContained) {
    // Pictures are data URIs, and nothing names another file or host.
    const std::string html = to_html(hostile_page());
    EXPECT_THAT(html, HasSubstr("src=\"data:image/png;base64,AQIDBA==\""));
    for (const char* reference : {"http:", "https:", "href=", "url(", "@import"}) {
        EXPECT_THAT(html, Not(HasSubstr(reference)));
    }
}

TEST(Page, IsWrittenWholeOrNotAtAll) {
    write_page(hostile_page(), "page.html");
    std::ostringstream content;
    content << std::ifstream("page.html").rdbuf();
    EXPECT_EQ(content.str(), to_html(hostile_page()));
    EXPECT_THROW(write_page(hostile_page(), "no_such_folder/page.html"), Error);
    EXPECT_THROW(read_image("no_such_picture.png", "none"), Error);
}

TEST(Plot, IsAnSvgWithEveryCurveOrNothing) {
    // Nothing is a right answer only where gnuplot is missing.
    const Plot plot{
        "It's", "x", "y", {{"'first'\n", {0, 1}, {1, 2}}, {"second", {0, 1}, {2, 1}}}, false};
    const std::optional<Image> image = draw(plot, "caption");
    if (!image) {
        GTEST_SKIP() << "gnuplot is not installed";
    }
    EXPECT_EQ(image->media_type, "image/svg+xml");
    EXPECT_THAT(image->bytes, HasSubstr("</svg>"));
    EXPECT_THAT(image->bytes, HasSubstr("second"));
}

}  // namespace
}  // namespace nearfield::report
