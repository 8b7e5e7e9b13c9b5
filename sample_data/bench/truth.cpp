// SPDX-License-Identifier: Apache-2.0
#include "formats/files/atomic_file.h"
#include "sample_data/bench/bench_json.h"
#include "sample_data/bench/prepared.h"

namespace nearfield::sample_data {

void write_truth(const PreparedBench& prepared, const std::string& path) {
    const Places& places = prepared.places;
    Json positions = Json::array(), boards = Json::array();
    for (const glm::dvec2& position_m : places.position_m)
        positions.push_back({position_m.x, position_m.y});
    for (const Rigid& pose : places.bench_from_board)
        boards.push_back(to_json(pose));
    Json truth;
    truth["bench"] = to_json(prepared.bench);
    truth["bench_from_lamp"] = to_json(places.bench_from_lamp);
    truth["bench_from_filter"] = to_json(places.bench_from_filter);
    truth["bench_from_screen"] = to_json(places.bench_from_screen);
    truth["position_m"] = std::move(positions);
    truth["bench_from_board"] = std::move(boards);
    truth["photometer_lx"] = prepared.photometer_lx;
    truth["photometer_open_lx"] = prepared.photometer_open_lx;
    truth["photometer_room_lx"] = prepared.photometer_room_lx;
    truth["quadrature_error_rel"] = prepared.error.quadrature_rel;
    truth["optics_error_rel"] = prepared.error.total_rel;
    write_file(truth.dump(2) + "\n", path);
}

}  // namespace nearfield::sample_data
