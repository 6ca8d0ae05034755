// Scatter plots as SVG text, both axes logarithmic. For example time over error, or cost over viewers.
#pragma once

#include <string>
#include <vector>

namespace brume {

struct Point {
    std::string label;
    double x, y;   // > 0
    int group = 0; // points of a group have one colour
};

struct Plot {
    std::string title, x_label, y_label;
    std::vector<Point> points;
    bool front = true;   // True: mark the points of paretoFront() and join them
    bool joined = false; // True: join the points of each group in their order
};

// Indices of the points that no other point beats in both x and y (smaller is better), by rising x.
std::vector<size_t> paretoFront(const std::vector<Point>& points);

// The plot as SVG. Points that are not positive and finite are left out.
std::string svg(const Plot& plot);

} // namespace brume
