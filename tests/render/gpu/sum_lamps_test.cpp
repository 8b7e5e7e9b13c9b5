// SPDX-License-Identifier: Apache-2.0
// What the sum by OpenGL makes of lamps in a scene: slabs, places, materials, visibility, levels.
#include "formats/model/luminaire.h"
#include "formats/model/mip_sum.h"
#include "formats/model/profile.h"
#include "formats/model/window_sum.h"
#include "render/gpu/storage.h"
#include "tests/render/gpu/gl_fixture.h"
#include "tests/render/gpu/sum_run.h"
#include "tests/support/lamps.h"
#include "tests/support/random.h"
#include "tests/support/receivers.h"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <cstdlib>
#include <fstream>

namespace nearfield::render::gpu {
namespace {

using support::as_double;
using support::as_float;
using support::hard_receivers;
using support::HardReceiver;
using support::LampShape;
using support::Random;
using support::random_lamp;

constexpr double kStated = 1e-4;  // by light_sum.h
constexpr GLuint kCellsBinding = 6;

class LightSumOfLamps : public GlTest {};

std::vector<model::ReceiverF> receivers_before(const Slab& slab, double height_per_delta) {
    std::vector<model::ReceiverF> receivers;
    for (std::uint64_t seed = 1; seed <= 4; ++seed)
        for (const HardReceiver& hard : hard_receivers(slab, height_per_delta, seed))
            receivers.push_back(as_float(hard.receiver));
    return receivers;
}

Slab color_lamp(std::uint64_t seed, Weighting weighting = Weighting::Irradiance) {
    LampShape shape;
    shape.channels = 3;
    shape.decades = 1;
    return random_lamp(model::make_profile("bspline"), weighting, seed, shape);
}

void expect_close(glm::vec4 got, glm::dvec3 expected, double floor, const std::string& where) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(got[c], expected[c], kStated * std::max(expected[c], floor)) << where;
}

SlabPlacement placed_by(const glm::dmat4& world_from_slab, double scale) {
    SlabPlacement placement;
    placement.world_from_slab = world_from_slab;
    placement.slab_from_world = glm::inverse(world_from_slab);
    placement.slab_from_world_rotation = glm::transpose(glm::dmat3(world_from_slab)) / scale;
    return placement;
}

// Two slabs, one of them turned, scaled and mirrored; receivers are what the slabs' own frames see
// through the inverse, in double.
TEST_F(LightSumOfLamps, AddsSlabsWhereverTheyStand) {
    const Slab first = color_lamp(3), second = color_lamp(4, Weighting::Radiance);
    glm::dmat4 turned = glm::translate(glm::dmat4(1.0), {0.3, -0.2, 0.4});
    turned = glm::rotate(turned, 0.4, glm::normalize(glm::dvec3(1.0, -2.0, 0.5)));
    turned = glm::scale(turned, {-1.5, 1.5, 1.5});
    const SlabPlacement places[] = {{}, placed_by(turned, 1.5)};
    std::vector<SumSlab> slabs;
    slabs.push_back(upload_sum_slab(device(), model::prepare(first), true, places[0]));
    slabs.push_back(upload_sum_slab(device(), model::prepare(second), true, places[1]));
    LightSumPrograms programs;
    const std::vector<model::ReceiverF> receivers = receivers_before(first, 5.0);
    const SumLight light = run_sum(device(), programs, slabs, receivers);
    std::size_t from_both = 0;
    for (std::size_t k = 0; k < receivers.size(); ++k) {
        const model::Receiver world = as_double(receivers[k]);
        const model::Receiver there{
            glm::dvec3(places[1].slab_from_world * glm::dvec4(world.position_m, 1.0)),
            places[1].slab_from_world_rotation * world.normal};
        const glm::dvec3 a = model::irradiance(first, world), b = model::irradiance(second, there);
        from_both += a.x > 0.0 && b.x > 0.0 ? 1U : 0U;
        expect_close(light.irradiance[k], a + b, 0.0, "receiver " + std::to_string(k));
    }
    EXPECT_GT(from_both, 5U);
}

// Radiance = irradiance times what the material's diffuse part sends to the viewer; dim scales
// both.
TEST_F(LightSumOfLamps, ReflectsByTheDiffusePart) {
    std::vector<SumSlab> slabs;
    const Slab slab = color_lamp(5);
    slabs.push_back(upload_sum_slab(device(), model::prepare(slab), true, {}));
    LightSumPrograms programs;
    const std::vector<model::ReceiverF> receivers = receivers_before(slab, 2.0);
    SumRun run;
    run.dim = 0.25F;
    run.brdf.kind = shared::kBrdfGgx;
    run.brdf.diffuse = {0.5F, 0.25F, 0.125F};
    run.brdf.specular = glm::vec3(0.04F);
    run.eye_world_m = {0.4, 0.1, -0.3};
    const SumLight light = run_sum(device(), programs, slabs, receivers, run);
    for (std::size_t k = 0; k < receivers.size(); ++k) {
        const glm::dvec3 irradiance = 0.25 * model::irradiance(slab, as_double(receivers[k]));
        const glm::vec3 to_viewer =
            glm::normalize(glm::vec3(run.eye_world_m) - receivers[k].position_m);
        const double schlick =
            0.04 + 0.96 * std::pow(1.0 - std::clamp(static_cast<double>(
                                                        glm::dot(to_viewer, receivers[k].normal)),
                                                    0.0, 1.0),
                                   5.0);
        const glm::dvec3 albedo = (1.0 - schlick) * glm::dvec3(run.brdf.diffuse);
        expect_close(light.irradiance[k], irradiance, 1e-6, "irradiance");
        expect_close(light.radiance[k], irradiance * albedo / std::acos(-1.0), 1e-6, "radiance");
        EXPECT_EQ(light.radiance[k].a, 0.0F);  // no noise
    }
}

// Without color a lamp of three channels is its luminance.
TEST_F(LightSumOfLamps, IsLuminanceWithoutColor) {
    const Slab slab = color_lamp(6);
    std::vector<SumSlab> slabs;
    slabs.push_back(upload_sum_slab(device(), model::prepare(slab), false, {}));
    LightSumPrograms programs;
    const std::vector<model::ReceiverF> receivers = receivers_before(slab, 1.0);
    const SumLight light = run_sum(device(), programs, slabs, receivers);
    for (std::size_t k = 0; k < receivers.size(); ++k)
        expect_close(light.irradiance[k],
                     glm::dvec3(model::luminance(model::irradiance(slab, as_double(receivers[k])))),
                     1e-6, "receiver " + std::to_string(k));
}

// The light of every image through every cell alone: windows whose profile is that cell's.
struct CellLight {
    int column, row, image;  // of U's cells
    double irradiance;
};
std::vector<CellLight> light_of_cells(const Slab& slab, const model::Receiver& receiver) {
    const auto n = static_cast<int>(slab.profile.cells.size());
    std::vector<model::AxisWindows> x, y;
    for (std::size_t c = 0; c < slab.profile.cells.size(); ++c) {
        Slab one_cell = slab;
        for (std::size_t other = 0; other < slab.profile.cells.size(); ++other)
            if (other != c)
                one_cell.profile.cells[other] = {0.0, 0.0, 0.0};
        x.push_back(model::make_windows(one_cell, 0, receiver.position_m.x, receiver.position_m.z));
        y.push_back(model::make_windows(one_cell, 1, receiver.position_m.y, receiver.position_m.z));
    }
    const double scale =
        slab.weighting == Weighting::Irradiance ? slab.delta_m * slab.delta_m : 1.0;
    std::vector<CellLight> lights;
    for (int m = 0; m < slab.image_count(); ++m)
        for (int c = 0; c < n * n; ++c) {
            const int k = m % slab.grid.x, l = m / slab.grid.x;
            double sum = 0.0;
            model::add_image(
                slab, slab.coeffs.data() + slab.image_offset(0, m), 0,
                x[static_cast<std::size_t>(c % n)].of_basis[static_cast<std::size_t>(k)],
                y[static_cast<std::size_t>(c / n)].of_basis[static_cast<std::size_t>(l)],
                receiver.normal, &sum);
            lights.push_back({k + c % n, l + c / n, m, scale * sum});
        }
    return lights;
}

double shadowed(const Slab& slab,
                const model::Receiver& receiver,
                const std::vector<float>& seen,
                SumShadows shadows) {
    const auto n = static_cast<int>(slab.profile.cells.size());
    const auto seen_at = [&](int column, int row) {
        return static_cast<double>(
            seen[static_cast<std::size_t>(row * (slab.grid.x + n - 1) + column)]);
    };
    double total = 0.0;
    for (const CellLight& light : light_of_cells(slab, receiver)) {
        double visibility = seen_at(light.column, light.row);
        if (shadows == SumShadows::Pdis) {
            visibility = 0.0;
            for (int c = 0; c < n * n; ++c)
                visibility +=
                    seen_at(light.image % slab.grid.x + c % n, light.image / slab.grid.x + c / n) /
                    (n * n);
        }
        total += visibility * light.irradiance;
    }
    return total;
}

TEST_F(LightSumOfLamps, WeighsCellsByTheirVisibility) {
    Random random{11};
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance})
        for (const char* profile : {"box", "bilinear", "bspline"})
            for (const SumShadows shadows : {SumShadows::Shares, SumShadows::Pdis}) {
                LampShape shape;
                shape.decades = 1;
                const Slab slab = random_lamp(model::make_profile(profile), weighting, 9, shape);
                const auto n = static_cast<int>(slab.profile.cells.size());
                std::vector<float> seen(
                    static_cast<std::size_t>((slab.grid.x + n - 1) * (slab.grid.y + n - 1)));
                for (float& v : seen)
                    v = static_cast<float>(std::max(random.uniform(-0.5, 1.0), 0.0));
                const Buffer cells = make_buffer_of(device(), seen);
                glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kCellsBinding, cells.id());
                std::vector<SumSlab> slabs;
                slabs.push_back(upload_sum_slab(device(), model::prepare(slab), false, {}));
                LightSumPrograms programs;
                programs.shadows = shadows;
                programs.more_defines = {"CELLS_FROM_BUFFER"};
                for (const double height : {-0.7, 0.5, 10.0}) {
                    const std::vector<model::ReceiverF> receivers = receivers_before(slab, height);
                    const SumLight light = run_sum(device(), programs, slabs, receivers);
                    for (std::size_t k = 0; k < receivers.size(); ++k)
                        expect_close(
                            light.irradiance[k],
                            glm::dvec3(shadowed(slab, as_double(receivers[k]), seen, shadows)),
                            1e-6, std::string(profile) + " at " + std::to_string(height));
                }
            }
}

// With q every receiver gets the light of its own level.
TEST_F(LightSumOfLamps, SumsCoarserImagesByTheSameLevels) {
    LampShape shape;
    shape.texels = {101, 86};
    shape.decades = 1;
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance}) {
        const model::PreparedMips mips =
            model::prepare_mips(random_lamp(model::make_profile("bspline"), weighting, 12, shape));
        const Slab& slab = mips.levels.front().slab;
        std::vector<SumSlab> slabs;
        slabs.push_back(upload_sum_slab(device(), mips, false, {}));
        LightSumPrograms programs;
        for (const int q : {3, 8, 16}) {
            std::vector<model::ReceiverF> receivers;
            std::vector<int> levels(mips.levels.size(), 0);
            for (const double height : {0.05, 0.3, 1.0, 20.0})
                for (const model::ReceiverF& receiver : receivers_before(slab, height)) {
                    receivers.push_back(receiver);
                    ++levels[static_cast<std::size_t>(level_for(mips, receiver, q))];
                }
            EXPECT_LT(*std::ranges::max_element(levels), static_cast<int>(receivers.size()));
            SumRun run;
            run.q = q;
            const SumLight light = run_sum(device(), programs, slabs, receivers, run);
            for (std::size_t k = 0; k < receivers.size(); ++k) {
                const int level = level_for(mips, receivers[k], q);
                const Slab& coarse = mips.levels[static_cast<std::size_t>(level)].slab;
                const double expected = model::irradiance(coarse, as_double(receivers[k])).x;
                // One node stands for texels twice as wide a level: 4 times the error.
                const double stated =
                    weighting == Weighting::Radiance ? std::ldexp(kStated, 2 * level) : kStated;
                EXPECT_NEAR(light.irradiance[k].x, expected, stated * std::max(expected, 1e-6))
                    << "q = " << q << ", level " << level;
            }
        }
    }
}

TEST(LightSumVariants, PassTheReferenceCompiler) {
    for (const char* shadows : {"NO_SHADOWS", "HAS_SHADOWS"})
        for (const char* way : {"SHADOW_SHARES", "SHADOW_PDIS"})
            for (const char* weighting : {"IS_IRRADIANCE", "IS_RADIANCE"})
                for (const char* program : {"BY_MOMENTS", "BY_PIECES"}) {
                    const Defines defines{shadows, way, weighting, program, "HAS_COLOR"};
                    std::ofstream("sum.comp") << resolve("render/shaders/sum.comp", defines).text;
                    // NOLINTNEXTLINE(concurrency-mt-unsafe): no other thread runs here.
                    EXPECT_EQ(std::system("glslangValidator sum.comp > sum.log"), 0)
                        << std::ifstream("sum.log").rdbuf();
                }
}

}  // namespace
}  // namespace nearfield::render::gpu
