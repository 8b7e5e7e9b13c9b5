// SPDX-License-Identifier: Apache-2.0
// What does not fit a graphics card is refused with names and numbers.
#include "formats/files/error.h"
#include "formats/model/profile.h"
#include "render/gpu/render.h"
#include "tests/render/scenes.h"

#include <gmock/gmock.h>

#include <optional>

namespace nearfield::render {
namespace {

using testing::HasSubstr;

LightField lamp_of(glm::ivec2 grid, glm::ivec2 texels, int channels) {
    LightField lamp = test::one_window_lamp(0.002, 1.0F);
    Slab& slab = lamp.slabs[0];
    slab.grid = grid;
    slab.texels = texels;
    slab.channels = channels;
    slab.coeffs.assign(static_cast<std::size_t>(channels * slab.image_count()) * slab.texel_count(),
                       1.0F);
    return lamp;
}

std::optional<Error> refusal(const LightField& lamp, const RenderOptions& options = {}) {
    Scene scene = test::floor_scene();
    scene.luminaires = {test::write_lamp(lamp, "large", test::pose({0, 0, 1}, test::kDown))};
    test::add_blocker(scene, "sheet", {0, 0, 0.5}, {0.2, 0.2});
    RenderOptions small = options;
    small.size_px = {8, 6};
    try {
        render_gl(scene, small);
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "nothing was refused";
    return std::nullopt;
}

TEST(GlLimits, RefusesMoreImagesThanATextureHasLayers) {
    RenderOptions options;
    options.sampler = model::Sampler::Systematic;
    const std::optional<Error> error = refusal(lamp_of({70, 70}, {1, 1}, 1), options);
    ASSERT_TRUE(error.has_value());
    EXPECT_THAT(error->where, HasSubstr("a lamp's images"));
    EXPECT_THAT(error->what_, HasSubstr("too many images for a texture"));
    EXPECT_THAT(error->expected, HasSubstr("layers"));
    EXPECT_EQ(error->got, "4900");
}

TEST(GlLimits, RefusesImagesThatAreWiderThanATexture) {
    RenderOptions options;
    options.sampler = model::Sampler::Systematic;
    const std::optional<Error> error = refusal(lamp_of({1, 1}, {20000, 1}, 1), options);
    ASSERT_TRUE(error.has_value());
    EXPECT_THAT(error->what_, HasSubstr("too large for a texture"));
    EXPECT_EQ(error->got, "20000 x 1");
}

TEST(GlLimits, RefusesABasisOfTooManyCells) {
    LightField lamp = lamp_of({1, 1}, {1, 1}, 1);
    lamp.slabs[0].profile.name = "comb";
    lamp.slabs[0].profile.cells.assign(33, {0.5, 0.0, 0.0});
    const std::optional<Error> error = refusal(lamp);
    ASSERT_TRUE(error.has_value());
    EXPECT_EQ(error->where, "comb");
    EXPECT_EQ(error->got, "33");
}

// Maps of 1.6 TiB in all: the error names the pass, the lamp and how much it is.
TEST(GlLimits, NamesThePassThatNeedsTooMuchMemory) {
    RenderOptions options;
    options.shadow_maps.map_px = 16384;
    const std::optional<Error> error = refusal(lamp_of({40, 40}, {1, 1}, 1), options);
    ASSERT_TRUE(error.has_value());
    EXPECT_THAT(error->what_, HasSubstr("out of graphics memory"));
    EXPECT_THAT(error->where, HasSubstr("shadow maps of lamp 'large' in pass 'shadow maps' on "));
    EXPECT_THAT(error->expected + error->got, HasSubstr("1638400.0 MiB"));
}

}  // namespace
}  // namespace nearfield::render
