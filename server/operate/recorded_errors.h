// RecordedErrors: which measured errors go into a recording. They are bounded, and nothing is said twice.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/error/error_window.h"

namespace brume {

// Of one viewer's pictures of the last half minute by one method.
struct RecordedError {
    uint32_t viewer = 0;
    std::string method;
    ErrorEstimate error;
};

class RecordedErrors {
public:
    static constexpr size_t kMost = 16; // in one record

    // What is known now. Errors that are not known or not finite are left out, and viewers that are not among them are
    // forgotten.
    void set(std::span<const ViewError> errors);
    // Those that have changed since they were taken last, at most kMost: first those that waited longest.
    std::vector<RecordedError> take();
    // The next recording begins.
    void forget() { of_.clear(); }

private:
    struct One {
        ErrorEstimate now;
        bool changed = true;
        uint64_t taken = 0; // number of the last take() that gave it; 0: none
    };
    std::map<std::pair<uint32_t, std::string>, One> of_; // by viewer and method
    uint64_t takes_ = 0;
};

} // namespace brume
