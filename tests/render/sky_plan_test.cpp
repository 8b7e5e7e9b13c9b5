// SPDX-License-Identifier: Apache-2.0
// Which passes an environment calls for.
#include "formats/files/error.h"
#include "render/cpu/render.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"
#include "tests/render/sky_scenes.h"

#include <gmock/gmock.h>

#include <string>

namespace nearfield::render {
namespace {

using test::layer, test::metal, test::reference, test::small, test::sunny_sky, test::under;

std::string passes_in(const Rendered& rendered) {
    std::string text;
    for (const PlannedPass& pass : rendered.report.plan.passes)
        text += pass.is_in ? std::string(pass.name) + ";" : "";
    return text;
}

// Proves that a scene without environment runs none of it, one of diffuse materials no filtered
// samples, one of metals no harmonics, and that off is off; each with its reason.
TEST(Sky, OnlyWhereCalledFor) {
    const Scene diffuse = under(sunny_sky());
    Scene none = diffuse;
    none.environment.reset();
    EXPECT_EQ(passes_in(render_cpu(none, small(4))), "camera rays;");
    EXPECT_EQ(passes_in(render_cpu(diffuse, small(4))), "camera rays;environment;sky irradiance;");
    const Scene glossy = under(sunny_sky(), metal(shared::kBrdfPhong, 10.0F, {}));
    EXPECT_EQ(passes_in(render_cpu(glossy, small(4))),
              "camera rays;samples;gloss;environment;sky samples;");
    EXPECT_EQ(passes_in(reference(diffuse, 8)), "camera rays;environment;sky samples;");
    Scene with_roof = diffuse;
    test::add_blocker(with_roof, "roof", {0, 0, 2.0}, {1.0F, 1.0F});
    EXPECT_EQ(passes_in(render_cpu(with_roof, small(4))),
              "camera rays;environment;sky irradiance;sky rays;");

    Scene dimmed = diffuse;
    dimmed.environment->intensity = 0.0;
    dimmed.environment->path = "absent.exr";  // not opened
    EXPECT_EQ(passes_in(render_cpu(dimmed, small(4))), "camera rays;");
    RenderOptions off = small(4);
    off.effects.environment = Switch::Off;
    EXPECT_EQ(layer(render_cpu(diffuse, off).picture, "").values,
              layer(render_cpu(none, small(4)).picture, "").values);
    RenderOptions on = small(4);
    on.effects.environment = Switch::On;
    EXPECT_EQ(passes_in(render_cpu(none, on)), "camera rays;");
    EXPECT_THROW(render_cpu(under({"absent.exr", "absent.exr"}), small(4)), Error);

    const auto reason = [](const Rendered& rendered, PassId id) {
        for (const PlannedPass& pass : rendered.report.plan.passes)
            if (pass.id == id)
                return pass.reason;
        return std::string("no such pass");
    };
    EXPECT_THAT(reason(render_cpu(diffuse, small(4)), PassId::EnvironmentSamples),
                testing::HasSubstr("no material has a lobe"));
    EXPECT_THAT(reason(render_cpu(none, small(4)), PassId::EnvironmentSamples),
                testing::HasSubstr("the scene has none"));
    EXPECT_THAT(reason(render_cpu(diffuse, small(4)), PassId::Environment),
                testing::HasSubstr("sunny.exr"));
}

}  // namespace
}  // namespace nearfield::render
