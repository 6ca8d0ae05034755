// Scatter plots as SVG text, both axes logarithmic unless one is said to be linear. For example time over error, cost
// over viewers, or error over time.
#pragma once

#include <string>
#include <vector>

namespace brume {

struct Point {
    std::string label;
    double x, y;              // > 0; x may be anything on a linear axis
    int group = 0;            // points of a group have one colour
    double low = 0, high = 0; // bounds of y, drawn as a bar; 0: none
};

struct Plot {
    std::string title, x_label, y_label;
    std::vector<Point> points;
    bool front = true;     // True: mark the points of paretoFront() and join them
    bool joined = false;   // True: join the points of each group in their order
    bool linear_x = false; // True: the x axis is linear, from the least to the largest x
};

// Indices of the points that no other point beats in both x and y (smaller is better), by rising x.
std::vector<size_t> paretoFront(const std::vector<Point>& points);

// The plot as SVG. Points that are not positive and finite are left out.
std::string svg(const Plot& plot);

} // namespace brume
