// SPDX-License-Identifier: Apache-2.0
#include "app/bench/page_plots.h"
#include "app/bench/papers_run.h"
#include "formats/files/image.h"
#include "formats/report/plot.h"
#include "render/display.h"
#include "render/metrics.h"

#include <algorithm>

namespace nearfield::bench {
namespace {

// A picture has its first row on top.
Layer gray_layer(glm::ivec2 size_px, const std::vector<float>& y) {
    Layer layer{"", {"R", "G", "B"}, {}};
    for (int row = size_px.y - 1; row >= 0; --row)
        for (int column = 0; column < size_px.x; ++column)
            layer.values.insert(layer.values.end(), 3,
                                y[static_cast<std::size_t>(row * size_px.x + column)]);
    return layer;
}

}  // namespace

report::Image write_view(const std::string& path,
                         const std::string& caption,
                         glm::ivec2 size_px,
                         const std::vector<float>& y,
                         const std::vector<float>& reference_y) {
    render::DisplayOptions options;
    options.tonemap = render::ToneMap::Papers;
    options.exposure_ev =
        render::automatic_exposure_ev(gray_layer(size_px, reference_y), options.tonemap);
    const Picture picture{size_px, {gray_layer(size_px, y)}, {}};
    write_png(render::display(picture, options).srgb, size_px, path);
    return report::read_image(path, caption);
}

std::optional<report::Image> draw_error(const std::string& title,
                                        glm::ivec2 size_px,
                                        const std::vector<float>& y,
                                        const std::vector<float>& reference_y) {
    WallPictures frame;
    frame.wall = {glm::dvec2(0.0), glm::dvec2(size_px), 0.0, size_px};
    frame.truth_y = reference_y;
    WallPicture picture;
    picture.y = y;
    report::HeatMap map = error_map(frame, picture);
    map.title = title;
    map.x_label = map.y_label = "px";
    map.flip_x = false;
    return report::draw(map, title);
}

}  // namespace nearfield::bench
