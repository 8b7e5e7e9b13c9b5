// SPDX-License-Identifier: Apache-2.0
#include "formats/model/sampler.h"

namespace nearfield::model {

std::string name_of(Sampler sampler) {
    switch (sampler) {
        case Sampler::Uniform:
            return "uniform";
        case Sampler::Precomputed:
            return "precomputed";
        case Sampler::Pdis:
            return "pdis";
        case Sampler::Systematic:
            return "systematic";
        case Sampler::Cells:
            return "cells";
    }
    return "";
}

std::string name_of(Sequence sequence) {
    switch (sequence) {
        case Sequence::Halton:
            return "halton";
        case Sequence::R2:
            return "r2";
        case Sequence::Fibonacci:
            return "fibonacci";
        case Sequence::Sobol:
            return "sobol";
    }
    return "";
}

std::string name_of(Shift shift) {
    switch (shift) {
        case Shift::Constant:
            return "constant";
        case Shift::Random:
            return "random";
        case Shift::BlueNoise:
            return "blue-noise";
        case Shift::Interleaved:
            return "interleaved";
    }
    return "";
}

Sequence default_sequence(Sampler sampler) {
    return sampler == Sampler::Systematic || sampler == Sampler::Cells ? Sequence::R2
                                                                       : Sequence::Halton;
}

}  // namespace nearfield::model
