#version 460
// The square of each number; `numbers` holds as many as there are lanes.
layout(local_size_x = 8) in;

layout(std430) readonly buffer Numbers { float numbers[]; };
layout(std430) writeonly buffer Squares { float squares[]; };

void main() { squares[gl_LocalInvocationIndex] = numbers[gl_LocalInvocationIndex] * numbers[gl_LocalInvocationIndex]; }
