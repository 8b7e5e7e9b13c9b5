// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/survey.h"

#include "formats/rays/ray_file.h"

#include <cmath>
#include <limits>

namespace nearfield::rays {
namespace {

// The point p nearest to lines x_r + t d_r solves
//     (sum w (1 - d d^T)) p = sum w (1 - d d^T) x
class NearestPoint {
  public:
    void add(const Ray& ray) {
        const glm::dvec3 d(ray.direction);
        const auto weight = static_cast<double>(ray.flux);
        const glm::dmat3 across = weight * (glm::dmat3(1.0) - glm::outerProduct(d, d));
        matrix_ += across;
        right_side_ += across * glm::dvec3(ray.position_m);
    }

    std::optional<glm::dvec3> point() const {
        // Of parallel lines the determinant is rounding: the matrix has trace 2 w.
        const double scale = (matrix_[0][0] + matrix_[1][1] + matrix_[2][2]) / 3;
        constexpr double kSingular = 1e-9;
        if (!(glm::determinant(matrix_) > kSingular * scale * scale * scale))
            return std::nullopt;
        return glm::inverse(matrix_) * right_side_;
    }

  private:
    glm::dmat3 matrix_{0.0};
    glm::dvec3 right_side_{0.0};
};

}  // namespace

RaySurvey survey_rays(const std::string& path, bool keep_radiometric) {
    RayFile file(path, keep_radiometric);
    const RayLayout& layout = file.layout();
    RaySurvey survey;
    survey.format = layout.format;
    survey.quantity = file.decoder().quantity();
    survey.notes = layout.notes;
    const double stated =
        survey.quantity == Quantity::Photometric ? layout.luminous_flux_lm : layout.radiant_flux_w;
    survey.flux_stated = std::isfinite(stated) && stated > 0 ? stated : 0;
    constexpr double kFar = std::numeric_limits<double>::infinity();
    survey.least_start_m = glm::dvec3(kFar);
    survey.most_start_m = glm::dvec3(-kFar);
    NearestPoint nearest;
    for (RayChunk chunk; file.next(chunk);) {
        survey.rays += chunk.rays.size();
        for (const Ray& ray : chunk.rays) {
            survey.flux += static_cast<double>(ray.flux);
            survey.least_start_m = glm::min(survey.least_start_m, glm::dvec3(ray.position_m));
            survey.most_start_m = glm::max(survey.most_start_m, glm::dvec3(ray.position_m));
            if (ray.direction.z < 0) {
                ++survey.backward_rays;
                survey.backward_flux += static_cast<double>(ray.flux);
            }
            nearest.add(ray);
        }
    }
    survey.focus_m = nearest.point();
    return survey;
}

}  // namespace nearfield::rays
