// SPDX-License-Identifier: Apache-2.0
/// IES LM-63, the American photometric file. Sources: the editions of 1986, 1991, 1995, 2002 and
/// 2019; docs/photometry.md says what is read of them and where files at large differ.
#pragma once

#include "formats/photometry/photometry.h"
#include "formats/photometry/text_file.h"

namespace nearfield::photometry {

/// Whether a line of the file's head is that of the tilt, which all editions have.
bool is_lm63(const TextFile& file);

/// Throws Error with line, expected and got where the file breaks its edition's rules.
Photometry read_lm63(const TextFile& file);

/// The file's text, after the edition of 2002, lengths in metres; symmetries that are exact are
/// used. Factors are in the intensities: multiplier and ballast factor are written as 1.
/// Throws Error where the photometry is none (check).
std::string to_lm63(const Photometry& photometry);

}  // namespace nearfield::photometry
