// SPDX-License-Identifier: Apache-2.0
#include "app/bench/papers_text.h"

#include <array>
#include <string_view>

namespace nearfield::bench {
namespace {

// A row of ours that a number of the paper's stands beside; empty: any.
struct StatedNumber {
    std::string_view figure, view, lamp, method, setting, text;
};

constexpr std::array<StatedNumber, 22> kStated = {{
    {"5", "", "", "pdis", "secant, depth 3", "83 ms, 0.89 Lab"},
    {"5", "", "", "pdis", "bisection, depth 3", "83 ms, 0.93 Lab"},
    {"7", "", "", "eye", "paper", "1.2 Lab"},
    {"9", "", "", "pdis", "K_max 7", "13.5 fps"},
    {"9", "", "", "pdis", "no limit", "11.6 fps"},
    {"9", "", "", "pdis", "between the two", "0.63 Lab, at most 23"},
    {"11", "", "", "precomputed", "K = 63000", "4821 ms"},
    {"11", "", "", "pdis", "K = 63", "62 ms"},
    {"11", "", "", "pdis", "K = 1000", "359 ms"},
    {"12", "", "", "pdis", "K = 252", "118 ms, 1.4 Lab"},
    {"12", "", "", "uniform", "K = 252", "84 ms, 3.4 Lab"},
    {"12", "", "", "uniform", "K = 1008", "201 ms, 1.4 Lab"},
    {"13", "driver", "", "pdis", "K = 100", "50 ms, 1.12 Lab"},
    {"13", "driver", "", "pdis", "K = 200", "84 ms, 0.84 Lab"},
    {"13", "driver", "", "pdis", "K = 400", "149 ms, 0.53 Lab"},
    {"13", "bird", "", "pdis", "K = 100", "0.81 Lab"},
    {"13", "bird", "", "pdis", "K = 200", "0.59 Lab"},
    {"13", "bird", "", "pdis", "K = 400", "0.36 Lab"},
    {"tables", "", "9x7", "tables", "", "513 ms"},
    {"tables", "", "5x5", "tables", "", "129 ms"},
    {"tables", "", "11x9", "tables", "", "527 ms"},
    {"2", "", "2 x 11x9", "pdis", "", "9 fps (figure 10)"},
}};

bool fits(std::string_view wanted, std::string_view got) {
    return wanted.empty() || wanted == got;
}

}  // namespace

const std::vector<FigureText>& figure_texts() {
    static const std::vector<FigureText> texts = {
        {"tables", "Precomputation and memory (section 7)",
         "\"The precomputation time (CDFs, sat and reference light positions for shadow maps) for "
         "all light field data listed in Table 1 is quite low: 513ms for bike, 129ms for car1 and "
         "527ms for car2.\" \"For the car2 data the whole light field and colored Cm (s) textures "
         "add up to 123MB\", the G-buffers take 24 MB. (99 x 256 x 256 texels of five floats, one "
         "CDF, one summed-area table and three colors, are 124 MiB.)",
         "Building the tables that samplers read: totals, medians, summed-area tables in pairs "
         "of floats, CDFs (which only pdis and precomputed read), mips. The sum needs none of "
         "them. In the file C_m has three channels. On the graphics card: what the renderer's "
         "textures of a lamp hold."},
        {"2", "Frame rates (figures 2, 10 and 14, section 7)",
         "\"The companion video shows the interactive frame rates, ranging from 7 to 15fps, of "
         "our GPU implementation.\" Figure 2: 12, 9 and 7 fps at 200 samples a pixel, of the "
         "bike's lamp with 80 shadow maps of 256 x 256 and of car headlights of 11 x 9 images. "
         "Figure 10: 9 fps for two headlights (car2, 200 samples). Figure 14: 8 fps on average "
         "while lamps are moved.",
         "Whole frames of the demo's road with shadows and glossy paint, all passes but the "
         "loading of lamps: shadow maps anew in each frame, as with lamps that move. K = 200 of "
         "a pixel and lamp: samples of samplers; for the sum shadow rays (CPU), or none (OpenGL, "
         "whose maps are read by the sum itself). A frame of 8 x 6 pixels shows what is spent "
         "whatever the size: compiling shaders and rendering maps (OpenGL)."},
        {"10", "Figure 10: where a frame's time goes",
         "Two headlights (car2), 200 samples a pixel, 9 fps: sampling 33.6 %, shading 31.9 %, "
         "accumulation buffer 16.2 %, shadow 9.2 %, A_m(p) (\"Est. A\") 5.3 %, other 3.8 %.",
         "The passes of the same frames, two lamps of 11 x 9 images. \"box energies\" is the "
         "paper's \"Est. A\"; \"samples\" is sampling, shading and its accumulation buffer in "
         "one: samples are added up in registers."},
        {"5", "Figure 5: depth of the search",
         "\"For a search depth of three, our new binary search gives a qualitatively better "
         "results (0.89 vs. 0.93 Lab error). Both results are computed in 83ms using 200 samples "
         "per pixel.\"",
         "pdis on the lamp of 9 x 7 images, K = 200, by the modified secant search and by "
         "bisection of several depths."},
        {"7", "Figure 7: shadow maps against rays",
         "\"The light source used the car1 data and our algorithm is implemented with 49 shadow "
         "maps (192x192). As confirmed by the mean Lab error (1.2) the visual difference between "
         "the two images is low.\" 400 samples a pixel against a ray tracer's 8000.",
         "The light of the lamp of 5 x 5 images (49 cells) on white matt surfaces without "
         "sampling noise: by maps on the OpenGL device against traced rays. \"eye\": where a map "
         "is rendered from, \"paper\" on S as published, \"cell\" on U, the default. Time: "
         "rendering the maps. The paper's Lab error holds its sampling noise too."},
        {"8", "Figure 8: sequences",
         "\"When used with a small number of samples, Halton sequence gives better result than "
         "the one generated with Mersenne Twister\"; for many samples the Mersenne Twister serves "
         "as the reference. No numbers are given.",
         "Lamp of 5 x 5 images; systematic, shifted at random from pixel to pixel, by four "
         "sequences, and by as many independent samples (frames of one sample each, averaged) in "
         "place of a pseudo-random generator."},
        {"9", "Figure 9: at most 7 samples an image",
         "K = 200, bike: \"with: 13.5fps\", \"without: 11.6fps\"; \"setting Kmax = 7 does not "
         "introduce large visual differences since the maximum Lab error is only 23 (0.63 mean "
         "error) between the two images.\"",
         "pdis, K = 200, lamp of 9 x 7 images. \"between the two\": the frame with the limit "
         "against the frame without, by differences; the other rows against exact light."},
        {"11", "Figure 11: precomputed samples",
         "bike: 63,000 precomputed samples in 4821 ms; the paper's sampling 62 ms with 63 samples "
         "a pixel, 359 ms with 1000; a reference of 63 M samples in 12 hours. \"With less samples "
         "per pixel (63 vs. 63000), our dynamic approach achieves a drastically higher quality "
         "with 1000 times less samples per pixel and is almost two orders of magnitude faster\".",
         "Lamp of 9 x 7 images, a small frame, since 63,000 samples are found anew for every pixel "
         "here (the paper draws them once and shades all pixels with them)."},
        {"12", "Figure 12: uniform samples",
         "bike: 252 samples of the paper's sampling in 118 ms, 1.4 Lab; 252 uniform ones in 84 "
         "ms, 3.4 Lab; 1008 uniform ones in 201 ms, 1.4 Lab. \"For almost the same quality (1.4 "
         "Lab error), our approach requires four times less samples\".",
         "Lamp of 9 x 7 images; uniform: as many samples in every image, anywhere in its window."},
        {"13", "Figure 13: convergence",
         "car1, from near and from far: 100 samples a pixel in 50 ms, 1.12 and 0.81 Lab; 200 in 84 "
         "ms, 0.84 and 0.59; 400 in 149 ms, 0.53 and 0.36. The reference is 25 M samples, 6 hours.",
         "Lamp of 5 x 5 images from the cameras \"driver\" (nearer) and \"bird\" (farther)."},
        {"all", "All samplers at the same number of samples",
         "The paper compares its sampling with precomputed and with uniform samples (figures 11 "
         "and 12); it has no exact sum.",
         "Lamp of 11 x 9 images, K = 200 in the pictures. Errors are colored from 0.1 % to 100 "
         "%; white is also where there is hardly any light. uniform draws at least one sample "
         "of every image in view, also where K is less."}};
    return texts;
}

std::string stated(const PapersRow& row) {
    for (const StatedNumber& number : kStated)
        if (number.figure == row.figure && fits(number.view, row.view) &&
            fits(number.lamp, row.lamp) && fits(number.method, row.method) &&
            fits(number.setting, row.setting))
            return std::string(number.text);
    return "";
}

}  // namespace nearfield::bench
