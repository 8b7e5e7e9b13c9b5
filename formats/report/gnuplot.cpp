// SPDX-License-Identifier: Apache-2.0
#include "formats/report/gnuplot.h"

#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace nearfield::report {

// gnuplot 5.4 does not read a doubled quote everywhere, so a quote becomes the typographic one.
std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) {
        result += c == '\'' ? std::string("\u2019") : std::string(1, c == '\n' ? ' ' : c);
    }
    return result + "'";
}

std::optional<std::string> run_gnuplot(const std::string& script) {
    std::string path = (std::filesystem::temp_directory_path() / "nearfield-plot-XXXXXX").string();
    const int descriptor = mkstemp(path.data());
    if (descriptor < 0) {
        return std::nullopt;
    }
    std::FILE* const file = fdopen(descriptor, "wb");
    const bool is_written = std::fwrite(script.data(), 1, script.size(), file) == script.size();
    const bool is_closed = std::fclose(file) == 0;
    std::optional<std::string> output;
    if (is_written && is_closed) {
        if (std::FILE* const pipe = popen(("gnuplot '" + path + "' 2>/dev/null").c_str(), "r")) {
            std::string bytes;
            std::array<char, 65536> block;
            for (std::size_t got = 0;
                 (got = std::fread(block.data(), 1, block.size(), pipe)) > 0;) {
                bytes.append(block.data(), got);
            }
            if (pclose(pipe) == 0 && !bytes.empty()) {
                output = std::move(bytes);
            }
        }
    }
    unlink(path.c_str());
    return output;
}

}  // namespace nearfield::report
