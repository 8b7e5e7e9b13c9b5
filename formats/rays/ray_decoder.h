// SPDX-License-Identifier: Apache-2.0
/// From rows of numbers to rays: units, flux, color. The same for every format.
#pragma once

#include "formats/rays/color.h"
#include "formats/rays/ray_layout.h"
#include "formats/rays/ray_rows.h"
#include "formats/rays/ray_set.h"

#include <vector>

namespace nearfield::rays {

/// Consecutive rays of a file.
struct RayChunk {
    std::vector<Ray> rays;
    std::vector<glm::vec3> colors;  // one a ray, or none: unknown, or the same for all
    double flux = 0;                // of the rays
    double stored_flux = 0;         // the same as the file holds it (W where they became lm)
    std::size_t desaturated = 0;
};

class RayDecoder {
  public:
    /// `layout` must outlive it.
    RayDecoder(const RayLayout& layout, bool keep_radiometric);

    Quantity quantity() const {
        return photometric_ ? Quantity::Photometric : Quantity::Radiometric;
    }
    /// Radiant flux becomes luminous flux, by V of the rays' wavelengths.
    bool to_luminous() const { return to_luminous_; }
    /// The color that all rays share, if they do.
    const std::vector<UnitColor>& shared_color() const { return shared_color_; }

    /// Throws Error naming byte and ray of the first row that holds a number that is not finite, a
    /// direction of no length, negative flux or an unknown spectrum. On all threads.
    void decode(const RayRows& rows, const RowReader& reader, RayChunk& chunk) const;

  private:
    // A spectrum's color and luminous efficacy.
    struct Light {
        UnitColor color;
        double lm_per_w = 0;
    };
    struct Sums {
        double flux = 0, stored_flux = 0;
        std::size_t desaturated = 0;
        bool is_well = true;
    };

    static Light monochromatic(double wavelength_nm);
    static Light integrate(const SpectralTable& table);
    const char* complaint_of(const float* row) const;  // nullptr: a ray
    Light light_of(const float* row) const;
    Ray ray_of(const float* row, double flux) const;
    Sums decode_rows(const RayRows& rows,
                     std::size_t begin,
                     std::size_t end,
                     RayChunk& chunk) const;

    const RayLayout& layout_;
    std::size_t flux_column_ = 0;
    std::vector<std::size_t> checked_;  // columns that must be finite
    std::vector<Light> lights_;         // of the tables, or the one for all
    std::vector<UnitColor> shared_color_;
    bool photometric_ = false, to_luminous_ = false, has_own_light_ = false;
};

}  // namespace nearfield::rays
