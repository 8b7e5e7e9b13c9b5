// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/photometric_file.h"

#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/read_file.h"
#include "formats/photometry/eulumdat.h"
#include "formats/photometry/lm63.h"
#include "formats/photometry/tm33.h"

#include <fstream>

namespace nearfield::photometry {

bool holds_photometry(const std::string& path) {
    constexpr std::size_t kHeadBytes = std::size_t{256} << 10;
    std::ifstream file(path, std::ios::binary);
    std::string head(kHeadBytes, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    if (head.find('\0') != std::string::npos)
        return false;
    const TextFile text = split_lines(path, head);
    return is_xml(head) || is_lm63(text) || is_eulumdat(text);
}

Photometry read_photometry(const std::string& path, const ReadOptions& options) {
    const std::string bytes = read_file(path);
    const TextFile file = split_lines(path, bytes);
    if (is_xml(bytes))
        return read_tm33(bytes, path);
    if (is_lm63(file))
        return read_lm63(file);
    if (is_eulumdat(file))
        return read_eulumdat(file, options.lamp_set);
    throw Error{
        "not a photometric file", path,
        "LM-63 (a line 'TILT='), EULUMDAT (line 2 type, 3 symmetry, 4 planes, 6 angles) or TM-33 "
        "(XML)",
        file.lines.empty() ? "an empty file" : shown(file.lines[0])};
}

std::optional<FileFormat> file_format_of(const std::string& path) {
    for (const auto& [suffix, format] : {std::pair{".ies", FileFormat::Lm63},
                                         {".IES", FileFormat::Lm63},
                                         {".ldt", FileFormat::Eulumdat},
                                         {".LDT", FileFormat::Eulumdat},
                                         {".xml", FileFormat::Tm33},
                                         {".XML", FileFormat::Tm33}})
        if (path.ends_with(suffix))
            return format;
    return std::nullopt;
}

void write_photometry(const Photometry& photometry, FileFormat format, const std::string& path) {
    switch (format) {
        case FileFormat::Lm63:
            return write_file(to_lm63(photometry), path);
        case FileFormat::Eulumdat:
            return write_file(to_eulumdat(photometry), path);
        case FileFormat::Tm33:
            return write_file(to_tm33(photometry), path);
    }
}

}  // namespace nearfield::photometry
