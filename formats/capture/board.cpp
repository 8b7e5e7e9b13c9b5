// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/board.h"

#include "formats/capture/words.h"
#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>
#include <string_view>
#include <vector>

namespace nearfield::capture {
namespace {

constexpr Words<BoardKind, 2> kBoardKinds{
    {{"charuco", BoardKind::Charuco}, {"chessboard", BoardKind::Chessboard}}};

constexpr std::array<std::string_view, 17> kDictionaries = {
    "4x4_50",  "4x4_100",  "4x4_250", "4x4_1000", "5x5_50",   "5x5_100",
    "5x5_250", "5x5_1000", "6x6_50",  "6x6_100",  "6x6_250",  "6x6_1000",
    "7x7_50",  "7x7_100",  "7x7_250", "7x7_1000", "original",
};

constexpr int kLeastSquares = 3, kMostSquares = 100;
constexpr double kLeastSide_m = 1e-5, kMostSide_m = 10;

double side_from(const JsonField& field, double most_m) {
    const double side_m = field.number();
    if (!(side_m >= kLeastSide_m && side_m <= most_m))
        throw Error{"bad value", field.where(), fmt::format("{} ... {}", kLeastSide_m, most_m),
                    fmt::format("{}", side_m)};
    return side_m;
}

std::string dictionary_from(const JsonField& field) {
    std::string name = field.text();
    if (std::find(kDictionaries.begin(), kDictionaries.end(), name) == kDictionaries.end())
        throw Error{"bad value", field.where(),
                    "one of OpenCV's dictionaries, 4x4_50 ... 7x7_1000 or original",
                    "'" + name + "'"};
    return name;
}

// A word as the JSON value that it would be in a plan.
Json number_in(const std::string& text, const std::string& where) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
        throw Error{"bad board", where, "a number", "'" + text + "'"};
    return value;
}

Json count_in(const std::string& text, const std::string& where) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
        throw Error{"bad board", where, "a count of squares", "'" + text + "'"};
    return value;
}

std::vector<std::string> parts_of(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::istringstream in(text);
    for (std::string part; std::getline(in, part, separator);)
        parts.push_back(part);
    return parts;
}

}  // namespace

BoardPlan board_from(const JsonField& field) {
    BoardPlan board;
    board.kind = meaning_of(kBoardKinds, field.at("kind"));
    const bool has_markers = board.kind == BoardKind::Charuco;
    field.only(has_markers ? std::vector<std::string>{"kind", "squares", "square_m", "marker_m",
                                                      "dictionary"}
                           : std::vector<std::string>{"kind", "squares", "square_m"});
    const std::vector<JsonField> squares = field.at("squares").elements(2);
    board.squares = {squares[0].integer(kLeastSquares, kMostSquares),
                     squares[1].integer(kLeastSquares, kMostSquares)};
    board.square_m = side_from(field.at("square_m"), kMostSide_m);
    if (has_markers) {
        board.marker_m = side_from(field.at("marker_m"), board.square_m);
        board.dictionary = dictionary_from(field.at("dictionary"));
    }
    return board;
}

Json json_of(const BoardPlan& board) {
    Json json = {{"kind", word_for(kBoardKinds, board.kind)},
                 {"squares", {board.squares.x, board.squares.y}},
                 {"square_m", board.square_m}};
    if (board.kind == BoardKind::Charuco) {
        json["marker_m"] = board.marker_m;
        json["dictionary"] = board.dictionary;
    }
    return json;
}

BoardPlan board_from_text(const std::string& text, const std::string& where) {
    const std::vector<std::string> parts = parts_of(text, ':');
    const std::vector<std::string> squares =
        parts.size() > 1 ? parts_of(parts[1], 'x') : std::vector<std::string>{};
    const std::size_t wanted = !parts.empty() && parts.front() == "charuco" ? 5 : 3;
    if (parts.size() != wanted || squares.size() != 2)
        throw Error{"bad board", where,
                    "charuco:8x6:0.03:0.0225:4x4_50 or chessboard:10x7:0.025 (squares, sides in m)",
                    "'" + text + "'"};
    Json json = {{"kind", parts[0]},
                 {"squares", {count_in(squares[0], where), count_in(squares[1], where)}},
                 {"square_m", number_in(parts[2], where)}};
    if (parts.size() == 5) {
        json["marker_m"] = number_in(parts[3], where);
        json["dictionary"] = parts[4];
    }
    return board_from({json, where});
}

}  // namespace nearfield::capture
