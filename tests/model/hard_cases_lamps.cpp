// SPDX-License-Identifier: Apache-2.0
// Hard cases of lamps, by the light sums: in float as renderers call them, in double as probe does,
// against the oracle at the very point that float represents.
#include "formats/model/luminaire.h"
#include "formats/model/mip_sum.h"
#include "formats/model/prepared.h"
#include "formats/model/profile.h"
#include "tests/model/hard_cases.h"
#include "tests/model/hard_cases_errors.h"
#include "tests/support/lamps.h"
#include "tests/support/oracle.h"
#include "tests/support/receivers.h"

#include <algorithm>
#include <cmath>

namespace nearfield::test {
namespace {

using model::PreparedSlab;
using model::Receiver;
using model::ReceiverF;
using support::as_double;
using support::as_float;
using support::hard_receivers;
using support::HardReceiver;
using support::LampShape;
using support::oracle_irradiance;
using support::random_lamp;

// Texels (i, j) of every image lit where `is_lit` says so.
template <typename IsLit>
Slab lamp_lit_where(glm::ivec2 texels, const IsLit& is_lit) {
    LampShape shape;
    shape.texels = texels;
    shape.dark_fraction = 0.0;
    Slab slab = random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 4, shape);
    for (std::size_t k = 0; k < slab.coeffs.size(); ++k) {
        const auto at = static_cast<int>(k % slab.texel_count());
        if (!is_lit(at % texels.x, at / texels.x))
            slab.coeffs[k] = 0.0F;
    }
    return slab;
}

SumErrors errors_of(const Slab& slab) {
    SumErrors errors;
    const PreparedSlab prepared = model::prepare(slab);
    std::uint64_t seed = 60;
    for (const double height : {-0.5, 0.0, 0.3, 1.0, 30.0})
        for (const HardReceiver& hard : hard_receivers(slab, height, ++seed))
            errors.add(slab, prepared, as_float(hard.receiver));
    return errors;
}

std::vector<HardRow> little_light() {
    std::vector<HardRow> rows;
    const auto add = [&](const std::string& name, const Slab& slab) {
        const SumErrors errors = errors_of(slab);
        rows.push_back({"relative error of E, " + name, 1e-3, errors.in_float, errors.in_double});
    };
    const glm::ivec2 size(24, 20);
    add("all dark", lamp_lit_where(size, [](int, int) { return false; }));
    add("one texel lit", lamp_lit_where(size, [](int i, int j) { return i == 11 && j == 9; }));
    add("one row lit", lamp_lit_where(size, [](int, int j) { return j == 10; }));
    add("one column lit", lamp_lit_where(size, [](int i, int) { return i == 12; }));
    add("the last column lit", lamp_lit_where(size, [](int i, int) { return i == 23; }));
    return rows;
}

std::vector<HardRow> widths() {
    std::vector<HardRow> rows;
    for (const int width : {300, 600, 1080}) {
        const SumErrors errors = errors_of(
            lamp_lit_where({width, 7}, [](int i, int j) { return (i * 7 + j * 3) % 5 != 0; }));
        rows.push_back({"relative error of E, " + std::to_string(width) + " texels wide", 1e-3,
                        errors.in_float, errors.in_double});
    }
    return rows;
}

std::vector<HardRow> wide_range() {
    LampShape shape;
    shape.decades = 10;
    std::vector<HardRow> rows;
    for (const Weighting weighting : kWeightings) {
        const SumErrors errors = errors_at(weighting, every_height(), every_kind(), shape);
        rows.push_back({"relative error of E, range 1e10" + with(weighting), 1e-3, errors.in_float,
                        errors.in_double});
    }
    return rows;
}

// The slab mirrored in x.
Slab mirrored_lamp(const Slab& slab) {
    Slab mirrored = slab;
    mirrored.u_center_m.x = -slab.u_center_m.x;
    mirrored.s_min_m.x = -slab.s_max_m.x;
    mirrored.s_max_m.x = -slab.s_min_m.x;
    const int w = slab.texels.x, columns = slab.grid.x;
    for (int m = 0; m < slab.image_count(); ++m) {
        const int from = m / columns * columns + columns - 1 - m % columns;
        for (int t = 0; t < static_cast<int>(slab.texel_count()); ++t)
            mirrored.coeffs[slab.image_offset(0, m) + static_cast<std::size_t>(t)] =
                slab.coeffs[slab.image_offset(0, from) +
                            static_cast<std::size_t>(t / w * w + w - 1 - t % w)];
    }
    return mirrored;
}

// What an unmoved lamp gives at the very points that float represents beside the moved one.
struct Moved {
    double in_float = 0, in_double = 0;

    void add(const Slab& moved, const ReceiverF& there, const Slab& slab, const Receiver& here) {
        const double expected = oracle_irradiance(slab, here).x;
        in_float = std::max(in_float,
                            relative_error(irradiance(model::prepare(moved), there).x, expected));
        in_double =
            std::max(in_double, relative_error(irradiance(moved, as_double(there)).x, expected));
    }
};

std::vector<HardRow> poses() {
    std::vector<HardRow> rows;
    for (const Weighting weighting : kWeightings) {
        LampShape shape;
        shape.decades = 1;
        const Slab slab = random_lamp(model::make_profile("bspline"), weighting, 62, shape);
        const bool is_exact = weighting == Weighting::Irradiance;
        const double required = is_exact ? 1e-5 : 1e-4;
        Moved scaled, mirrored, rotated;
        for (const double height : {-0.5, 1.0, 1e3}) {
            const Receiver receiver = hard_receivers(slab, height, 62)[1].receiver;
            for (const double factor : {1e-3, 0.02, 7.0, 1e3}) {
                const ReceiverF there = as_float({receiver.position_m * factor, receiver.normal});
                scaled.add(support::scaled_lamp(slab, factor), there, slab,
                           {as_double(there).position_m / factor, as_double(there).normal});
            }
            const ReceiverF there = as_float(receiver);
            const glm::dvec3 flip(-1.0, 1.0, 1.0);
            const Receiver here{flip * as_double(there).position_m, flip * as_double(there).normal};
            mirrored.add(mirrored_lamp(slab), there, slab, here);
            // The receiver goes to the slab's frame in double, as renderers place lamps.
            Slab posed = slab;
            posed.luminaire_from_slab = {
                support::rotation_about(glm::normalize(glm::dvec3(1, -2, 0.5)), 1.234),
                {3.0, -1.0, 0.7}};
            const Receiver in_luminaire{
                posed.luminaire_from_slab.rotation * as_double(there).position_m +
                    posed.luminaire_from_slab.translation_m,
                posed.luminaire_from_slab.rotation * as_double(there).normal};
            rotated.add(posed, as_float(model::to_slab(posed, in_luminaire)), slab,
                        as_double(there));
        }
        const auto add = [&](const char* name, const Moved& moved) {
            rows.push_back({std::string("relative error of E, ") + name + with(weighting), required,
                            moved.in_float, moved.in_double});
        };
        add("scaled 1e-3, 0.02, 7, 1e3", scaled);
        add("mirrored", mirrored);
        add("rotated and moved", rotated);
    }
    return rows;
}

std::vector<HardRow> coarser_images() {
    LampShape shape;
    shape.texels = {37, 22};
    const Slab slab = random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 7, shape);
    double worst = 0.0, cropped = 0.0;
    Slab uncropped = slab;
    for (const PreparedSlab& level : model::prepare_mips(slab).levels) {
        worst = std::max(worst, relative_error(model::flux(level.slab).x, model::flux(slab).x));
        // Odd sizes within S's own rectangle: texels narrower than the ones that were averaged.
        uncropped = level.slab;
        uncropped.s_max_m = slab.s_max_m;
        cropped = std::max(cropped, relative_error(model::flux(uncropped).x, model::flux(slab).x));
    }
    return {{"relative error of flux on 37 x 22 texels' coarser levels", 1e-6, worst, std::nullopt,
             cropped}};
}

}  // namespace

std::vector<HardCase> lamp_cases() {
    return {
        {"LittleLight", "images all zero, one texel, row or column lit",
         "0/0, rows skipped or read twice at borders", little_light},
        {"Widths", "widths that are no power of two", "texels left out at a row's end", widths},
        {"WideRange", "range 1e10 within one image", "small texels lost beside large ones",
         wide_range},
        {"Poses", "lamp scaled 1e-3 … 1e3, rotated, mirrored", "hidden unit constants", poses},
        {"CoarserImages", "coarser images of odd sizes",
         "levels that keep S's rectangle lose or shift light", coarser_images},
    };
}

}  // namespace nearfield::test
