// Scatter plots as SVG text, both axes logarithmic: time against error, cost against viewers.
#pragma once

#include <string>
#include <vector>

namespace brume {

struct Point {
    std::string label;
    double x, y;   // > 0
    int group = 0; // colour
};

struct Plot {
    std::string title, x_label, y_label;
    std::vector<Point> points;
    bool front = true;   // mark the points that no other beats in both, and join them
    bool joined = false; // join the points of each group in their order
};

// Indices of the points that no other point beats in x and y, by rising x.
std::vector<size_t> paretoFront(const std::vector<Point>& points);

// Leaves out points that are not positive and finite.
std::string svg(const Plot& plot);

} // namespace brume
