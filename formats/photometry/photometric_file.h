// SPDX-License-Identifier: Apache-2.0
/// Reads and writes photometric files: IES LM-63 of every edition, EULUMDAT, and TM-33 (ATLA S001),
/// told by content, not by the name's suffix. docs/photometry.md.
#pragma once

#include "formats/photometry/photometry.h"

#include <optional>
#include <string>

namespace nearfield::photometry {

/// Whether a file begins as one of the formats does; false where it cannot be read. Looks at its
/// first 256 KiB alone, so that ray files of any size may be asked.
bool holds_photometry(const std::string& path);

struct ReadOptions {
    int lamp_set = 0;  // which of EULUMDAT's alternative lamps the table is scaled to
};

/// Reads a file. Throws Error naming file, line, expected and got where it is none of the formats,
/// or not as its format wants it. Cost: one pass, memory some ten times the file's size.
Photometry read_photometry(const std::string& path, const ReadOptions& options = {});

enum class FileFormat { Lm63, Eulumdat, Tm33 };

/// By the name's suffix: .ies, .ldt, .xml. Nothing for any other.
std::optional<FileFormat> file_format_of(const std::string& path);

/// Writes a file, whole or not at all. Throws Error as to_lm63, to_eulumdat and to_tm33 do.
void write_photometry(const Photometry& photometry, FileFormat format, const std::string& path);

}  // namespace nearfield::photometry
