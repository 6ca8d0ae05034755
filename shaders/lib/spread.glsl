// Workgroups in another order. A CPU driver gives each of its threads one run of neighbouring workgroups. Pixels and
// tiles of the dense part of a medium would be one thread's, while the others are done. Rows that follow one another
// are four apart here, and each is some workgroup's.

// The row of workgroups that stands at place `row` of `rows`: first all even ones, and so once more.
uint spreadRow(uint row, uint rows) {
    const uint even = (rows + 1) / 2;
    for (uint i = 0; i < 2; ++i) row = row < even ? 2 * row : 2 * (row - even) + 1;
    return row;
}

// Takes the place of gl_WorkGroupID.
uvec3 spreadGroup() {
    const uvec3 id = gl_WorkGroupID, count = gl_NumWorkGroups;
    if (count.z == 1) return uvec3(id.x, spreadRow(id.y, count.y), 0);
    const uint row = spreadRow(id.z * count.y + id.y, count.y * count.z), z = row / count.y;
    return uvec3(id.x, row - z * count.y, z);
}

// Takes the place of gl_GlobalInvocationID.
uvec3 spreadInvocation() { return spreadGroup() * gl_WorkGroupSize + gl_LocalInvocationID; }
