// SPDX-License-Identifier: Apache-2.0
/// Reads and writes photometric files: IES LM-63 of every edition and EULUMDAT, told by content,
/// not by the name's suffix. docs/photometry.md.
#pragma once

#include "formats/photometry/photometry.h"

#include <string>

namespace nearfield::photometry {

struct ReadOptions {
    int lamp_set = 0;  // which of EULUMDAT's alternative lamps the table is scaled to
};

/// Reads a file. Throws Error naming file, line, expected and got where it is neither format, or
/// not as its format wants it. Cost: one pass, memory some ten times the file's size.
Photometry read_photometry(const std::string& path, const ReadOptions& options = {});

enum class FileFormat { Lm63, Eulumdat };

/// Writes a file, whole or not at all. Throws Error as to_lm63 and to_eulumdat do.
void write_photometry(const Photometry& photometry, FileFormat format, const std::string& path);

}  // namespace nearfield::photometry
