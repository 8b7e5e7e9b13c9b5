// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/photometric_file.h"

#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/photometry/eulumdat.h"
#include "formats/photometry/lm63.h"

namespace nearfield::photometry {

Photometry read_photometry(const std::string& path, const ReadOptions& options) {
    const TextFile file = read_text(path);
    if (is_lm63(file))
        return read_lm63(file);
    if (is_eulumdat(file))
        return read_eulumdat(file, options.lamp_set);
    throw Error{"not a photometric file", path,
                "LM-63 (a line 'TILT=') or EULUMDAT (line 2 type, 3 symmetry, 4 planes, 6 angles)",
                file.lines.empty() ? "an empty file" : shown(file.lines[0])};
}

void write_photometry(const Photometry& photometry, FileFormat format, const std::string& path) {
    write_file(format == FileFormat::Lm63 ? to_lm63(photometry) : to_eulumdat(photometry), path);
}

}  // namespace nearfield::photometry
