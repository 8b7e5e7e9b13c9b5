// SPDX-License-Identifier: Apache-2.0
/// Writes ray files, a few rays at a time: memory does not grow with the file, which appears whole
/// under its name or not at all. Formats and their headers as in tm25.h, zemax.h and lighttools.h;
/// lengths in mm.
#pragma once

#include "formats/files/atomic_file.h"
#include "formats/rays/ray_set.h"

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::rays {

enum class RayFormat { Tm25, Zemax, ZemaxText, LightTools, LightToolsText };

/// Names as options have them, in the order of RayFormat.
std::vector<std::pair<std::string, RayFormat>> ray_format_names();
/// By the name's suffix: .tm25ray, .dat, .ray, .txt. Throws Error on any other.
RayFormat ray_format_of(const std::string& path);

/// What a header says.
struct RayFileFacts {
    RayFormat format = RayFormat::Tm25;
    std::uint64_t ray_count = 0;
    Quantity quantity = Quantity::Photometric;
    double flux = 0;         // of all rays
    bool has_color = false;  // of every ray; of TM-25 alone
    std::string creator;     // who made the rays; cut to what the format holds
};

class RayWriter {
  public:
    /// Throws Error where the format cannot hold what is asked for (Zemax: 4e9 rays), or the disk.
    RayWriter(const std::string& path, RayFileFacts facts);

    /// Colors: one a ray, linear Rec.709 per unit of flux, where facts say so; else none.
    void add(std::span<const Ray> rays, std::span<const glm::vec3> colors);
    /// Ends the file and gives it its name. All rays must have been added.
    void commit();

  private:
    void put(const std::string& bytes);
    std::string header() const;
    std::string binary_rows(std::span<const Ray> rays, std::span<const glm::vec3> colors) const;
    static std::string text_rows(std::span<const Ray> rays);

    RayFileFacts facts_;
    AtomicFile file_;
    std::uint64_t position_ = 0, added_ = 0;
};

}  // namespace nearfield::rays
