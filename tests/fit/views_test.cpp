// SPDX-License-Identifier: Apache-2.0
// The fit on real pictures: a two-plane light field of 9 x 9 cameras (Stanford's Lego knights),
// every fourth view held out and foretold by the fit of the others; a camera centered on u_k sees
// G_km = Phi_m(u_k). Beside it the nearest view, interpolation between neighbors, and the linear
// predictor that fits the held-out views themselves best: no choice of weights on the views can do
// better. Values are the pictures' own codes. What is not tested: views between rows of cameras.
#include "fit/smoothness.h"
#include "formats/model/profile.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace nearfield::fit {
namespace {

const std::string kFolder =
    std::string(NEARFIELD_SOURCE_DIR) + "/../shared/data/lightfield/legoknights_9x9";
constexpr int kCount = 9;   // of cameras along an axis
constexpr int kStride = 2;  // every other pixel of every other row

// A camera's picture, [channel][j][i] of codes, and its place in metres (file names: millimetres).
struct View {
    glm::dvec2 at_m{0.0};
    Eigen::VectorXf codes;
    int width = 0;
};

// Row by row; names are out_ROW_COLUMN_V_U.jpg.
std::vector<View> read_views() {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(kFolder))
        if (entry.path().extension() == ".jpg")
            paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    std::vector<View> views;
    for (const std::filesystem::path& path : paths) {
        View view;
        int row = 0, column = 0;
        double v_mm = 0, u_mm = 0;
        if (std::sscanf(path.stem().c_str(), "out_%d_%d_%lf_%lf", &row, &column, &v_mm, &u_mm) != 4)
            continue;
        view.at_m = 1e-3 * glm::dvec2(u_mm, v_mm);
        const cv::Mat picture = cv::imread(path.string(), cv::IMREAD_COLOR);
        view.width = picture.cols / kStride;
        view.codes.resize(Eigen::Index{3} * view.width * view.width);
        for (int c = 0, at = 0; c < 3; ++c)
            for (int j = 0; j < view.width; ++j)
                for (int i = 0; i < view.width; ++i, ++at)
                    view.codes[at] = picture.at<cv::Vec3b>(kStride * j, kStride * i)[c];
        views.push_back(std::move(view));
    }
    return views;
}

bool is_held_out(std::size_t k) {
    return k % 4 == 2;
}

// A grid of functions as dense as the cameras, one more on each side; whichever way the file's
// rows run.
Slab planes_of(const std::vector<View>& views) {
    glm::dvec2 least(1e9), most(-1e9);
    for (const View& view : views) {
        least = glm::min(least, view.at_m);
        most = glm::max(most, view.at_m);
    }
    Slab planes;
    planes.delta_m = 1;
    planes.weighting = Weighting::Radiance;
    planes.grid = glm::ivec2(kCount + 2);
    planes.pitch_m = (most - least) / (kCount - 1.0);
    planes.u_center_m = 0.5 * (least + most);
    planes.texels = glm::ivec2(views.front().width);
    planes.s_max_m = glm::dvec2(1);
    planes.profile = model::make_profile("bspline");
    planes.channels = 3;
    return planes;
}

// Of rows of all views that are not held out, or of one that is.
TileInput tile_of(const std::vector<const View*>& views, TileRange rows) {
    TileInput tile;
    for (int c = 0; c < 3; ++c)
        for (const View* view : views) {
            const float* from =
                view->codes.data() + (c * view->width + rows.first_row) * view->width;
            tile.value.insert(tile.value.end(), from, from + rows.row_count * view->width);
        }
    tile.variance.assign(tile.value.size(), 1.0F);
    return tile;
}

Design design_of(const Slab& planes, const std::vector<const View*>& views) {
    Optics optics;
    optics.sensor = Sensor::Camera;
    for (const View* view : views)
        optics.position_m.emplace_back(view->at_m, -planes.delta_m);
    return make_design(planes, optics);
}

// What the fit of `seen` foretells of `held`.
std::vector<Eigen::VectorXf> foretold_by_fit(const Slab& planes,
                                             const std::vector<const View*>& seen,
                                             const std::vector<const View*>& held) {
    const Design design = design_of(planes, seen);
    FitOptions options;
    options.channels = 3;
    SmoothnessOptions smoothness;
    smoothness.texel_step = 8;
    const TileRange middle{planes.texels.y / 2, 4};
    const SmoothnessCurve curve =
        cross_validate(design, options, smoothness, middle, tile_of(seen, middle));
    options.solve.lambda = curve.lambda[curve.best];
    std::printf("lambda %g, chi-square of held-out measurements %.1f codes^2\n",
                options.solve.lambda, curve.chi_square[curve.best]);
    const TileRange all{0, planes.texels.y};
    FitReport report;
    const TileResult fitted = solve_tile(design, options, all, tile_of(seen, all), report);
    EXPECT_EQ(report.unconverged_count, 0);
    EXPECT_LT(report.kkt_worst, 1e-9);

    TexelDesign texel;
    fill_texel_design(design_of(planes, held), 0, 0, texel);
    const std::size_t texels = planes.texel_count();
    const auto functions = static_cast<std::size_t>(planes.image_count());
    std::vector<Eigen::VectorXf> foretold(held.size(), Eigen::VectorXf(3 * texels));
    std::vector<double> coeffs(functions);
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t t = 0; t < texels; ++t) {
            for (std::size_t m = 0; m < functions; ++m)
                coeffs[m] = static_cast<double>(fitted.coeffs[(c * functions + m) * texels + t]);
            for (std::size_t k = 0; k < held.size(); ++k)
                foretold[k][static_cast<Eigen::Index>(c * texels + t)] =
                    static_cast<float>(predicted(texel, static_cast<int>(k), coeffs));
        }
    return foretold;
}

Eigen::VectorXf nearest(const std::vector<const View*>& seen, const View& held) {
    return (*std::min_element(seen.begin(), seen.end(),
                              [&](const View* a, const View* b) {
                                  return glm::distance(a->at_m, held.at_m) <
                                         glm::distance(b->at_m, held.at_m);
                              }))
        ->codes;
}

// Between the neighbors in the row and between those in the column, by measured places; the mean of
// both, or one on an edge.
Eigen::VectorXf interpolated(const std::vector<View>& views, std::size_t k) {
    const View& held = views[k];
    Eigen::VectorXf sum = Eigen::VectorXf::Zero(held.codes.size());
    float count = 0;
    const auto add = [&](const View& a, const View& b, int axis) {
        const auto share =
            static_cast<float>((held.at_m[axis] - a.at_m[axis]) / (b.at_m[axis] - a.at_m[axis]));
        sum += (1 - share) * a.codes + share * b.codes;
        ++count;
    };
    const std::size_t row = k / kCount, column = k % kCount;
    if (column > 0 && column + 1 < kCount)
        add(views[k - 1], views[k + 1], 0);
    if (row > 0 && row + 1 < kCount)
        add(views[k - kCount], views[k + kCount], 1);
    return sum / count;
}

// Weights on all seen views that come nearest to the held-out one, pixels and channels alike.
Eigen::VectorXf best_linear(const std::vector<const View*>& seen, const View& held) {
    Eigen::MatrixXf all(held.codes.size(), static_cast<Eigen::Index>(seen.size()));
    for (std::size_t k = 0; k < seen.size(); ++k)
        all.col(static_cast<Eigen::Index>(k)) = seen[k]->codes;
    const Eigen::MatrixXd normal = (all.transpose() * all).cast<double>();
    const Eigen::VectorXd right = (all.transpose() * held.codes).cast<double>();
    return all * normal.ldlt().solve(right).cast<float>();
}

double psnr_db(double square_sum, double count) {
    return 10 * std::log10(255.0 * 255.0 * count / square_sum);
}

struct Predictor {
    const char* name;
    std::vector<Eigen::VectorXf> views;  // of those held out

    double psnr_db(const std::vector<const View*>& held) const {
        double square = 0, count = 0;
        for (std::size_t k = 0; k < held.size(); ++k) {
            square += static_cast<double>(
                (views[k].cwiseMax(0.0F).cwiseMin(255.0F) - held[k]->codes).squaredNorm());
            count += static_cast<double>(held[k]->codes.size());
        }
        return fit::psnr_db(square, count);
    }
};

// The held-out view and what each predictor makes of it, side by side; below, what is wrong with
// it, four times enlarged about gray.
void write_picture(const View& truth, const std::vector<Predictor>& predictors, std::size_t k) {
    const int width = truth.width;
    cv::Mat picture(2 * width, width * static_cast<int>(predictors.size() + 1), CV_8UC3,
                    cv::Scalar(128, 128, 128));
    const auto clamped = [](float code) {
        return static_cast<std::uint8_t>(std::clamp(std::lround(code), 0L, 255L));
    };
    for (int c = 0, at = 0; c < 3; ++c)
        for (int j = 0; j < width; ++j)
            for (int i = 0; i < width; ++i, ++at) {
                picture.at<cv::Vec3b>(j, i)[c] = clamped(truth.codes[at]);
                for (std::size_t p = 0; p < predictors.size(); ++p) {
                    const int x = i + width * static_cast<int>(p + 1);
                    const float code = predictors[p].views[k][at];
                    picture.at<cv::Vec3b>(j, x)[c] = clamped(code);
                    picture.at<cv::Vec3b>(width + j, x)[c] =
                        clamped(128 + 4 * (code - truth.codes[at]));
                }
            }
    cv::imwrite("held_out_view.png", picture);
}

TEST(Views, HeldOutOnesAreForetoldBetterThanByTheirNeighbors) {
    if (!std::filesystem::exists(kFolder))
        GTEST_SKIP() << kFolder << " is not here";
    const std::vector<View> views = read_views();
    ASSERT_EQ(views.size(), std::size_t{kCount * kCount});
    std::vector<const View*> seen, held;
    Predictor near{"nearest view", {}}, between{"between neighbors", {}}, best{"best linear", {}};
    for (std::size_t k = 0; k < views.size(); ++k)
        (is_held_out(k) ? held : seen).push_back(&views[k]);
    for (std::size_t k = 0; k < views.size(); ++k)
        if (is_held_out(k)) {
            near.views.push_back(nearest(seen, views[k]));
            between.views.push_back(interpolated(views, k));
            best.views.push_back(best_linear(seen, views[k]));
        }
    const Predictor fitted{"fit", foretold_by_fit(planes_of(views), seen, held)};
    const std::vector<Predictor> all = {near, between, fitted, best};
    for (const Predictor& predictor : all)
        std::printf("%-18s %.2f dB\n", predictor.name, predictor.psnr_db(held));
    write_picture(*held[held.size() / 2], all, held.size() / 2);
    EXPECT_GT(fitted.psnr_db(held), near.psnr_db(held) + 2);
    EXPECT_GE(fitted.psnr_db(held), between.psnr_db(held));
    EXPECT_LT(fitted.psnr_db(held), best.psnr_db(held));
}

}  // namespace
}  // namespace nearfield::fit
