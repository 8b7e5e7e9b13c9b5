// SPDX-License-Identifier: Apache-2.0
#include "formats/files/repair.h"

#include "formats/files/exr_file.h"
#include "formats/files/lightfield_parts.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace nearfield {
namespace {

void repair_image(std::span<float> values, Repairs& repairs) {
    float largest = 0.0F;
    for (const float value : values)
        if (std::isfinite(value))
            largest = std::max(largest, value);
    for (float& value : values) {
        if (std::isnan(value)) {
            value = 0.0F;
            ++repairs.not_a_number;
        } else if (value < 0.0F) {  // -Inf too
            value = 0.0F;
            ++repairs.negative;
        } else if (std::isinf(value)) {
            value = largest;
            ++repairs.infinite;
        }
    }
}

}  // namespace

Repairs repair(LightField& lightfield) {
    Repairs repairs;
    const auto repair_images = [&repairs](const Slab& slab, std::vector<float>& values) {
        for (std::size_t at = 0; at < values.size(); at += slab.texel_count())
            repair_image({values.data() + at, slab.texel_count()}, repairs);
    };
    for (Slab& slab : lightfield.slabs) {
        repair_images(slab, slab.coeffs);
        repair_images(slab, slab.sigma);
        for (std::vector<float>& replicate : slab.replicates)
            repair_images(slab, replicate);
    }
    return repairs;
}

LightField read_broken_lightfield(const std::string& path) {
    exr::Reader reader(path);
    return read_lightfield_parts(reader, path, exr::Values::Any).lightfield;
}

}  // namespace nearfield
