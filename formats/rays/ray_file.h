// SPDX-License-Identifier: Apache-2.0
/// Reads ray files of every known format, which is told by content, not by the name's suffix:
/// IES TM-25, Zemax (binary, text), LightTools (binary, text), Speos. docs/ray_files.md.
#pragma once

#include "formats/rays/byte_reader.h"
#include "formats/rays/ray_decoder.h"
#include "formats/rays/ray_layout.h"
#include "formats/rays/ray_rows.h"
#include "formats/rays/ray_set.h"

#include <functional>
#include <string>

namespace nearfield::rays {

struct ReadOptions {
    /// Keep the sum of the rays' flux even where the header states another total.
    bool keep_ray_flux = false;
    /// Keep radiant flux as it is. By default it becomes luminous flux where the file gives
    /// wavelengths or spectra.
    bool keep_radiometric = false;
    std::function<void(double fraction)> progress;
};

/// A ray file, some ten thousand rays at a time: memory does not grow with the file.
class RayFile {
  public:
    /// Reads the header. Throws Error naming the byte where the file is none of the formats, or its
    /// header is damaged or promises rays that its size does not justify.
    RayFile(const std::string& path, bool keep_radiometric);
    RayFile(const RayFile&) = delete;
    RayFile& operator=(const RayFile&) = delete;

    const RayLayout& layout() const { return layout_; }
    const RayDecoder& decoder() const { return decoder_; }
    /// The next rays as the file has them, not scaled to the header's total; false: the end. Throws
    /// Error naming byte and ray, as RowReader and RayDecoder do.
    bool next(RayChunk& chunk);
    /// Read so far, 0 ... 1.
    double fraction() const;

  private:
    ByteReader bytes_;
    RayLayout layout_;
    RowReader reader_;
    RayDecoder decoder_;
    RayRows rows_;
};

/// Reads a whole file.
///
/// Out     rays whose flux is scaled to the header's total where it states one; notes say so.
/// Throws  Error as RayFile, and where all flux is 0.
/// Cost    one pass; 28 bytes of memory a ray (40 with color of its own).
RaySet read_rays(const std::string& path, const ReadOptions& options = {});

}  // namespace nearfield::rays
