// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <string>
#include <vector>

namespace nearfield {

/// Points and normals in the luminaire's frame, from a CSV file.
struct PointList {
    /// x_m,y_m,z_m,nx,ny,nz as the file has them, to be written back unchanged.
    std::vector<std::string> lines_text;
    std::vector<glm::dvec3> positions_m;
    std::vector<glm::dvec3> normals;  // of unit length
};

/// The columns that read_points looks for, in the order of lines_text.
constexpr const char* kPointColumns = "x_m,y_m,z_m,nx,ny,nz";

/// Reads a CSV file whose header names the columns above in any order; others are ignored. "-" is
/// the standard input. Throws Error with line and column where a value is no finite number or a
/// normal is zero.
PointList read_points(const std::string& path);

}  // namespace nearfield
