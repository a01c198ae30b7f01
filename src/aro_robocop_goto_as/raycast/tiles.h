/* Segments in square tiles, row by row. */
#ifndef ARO_TILES_H
#define ARO_TILES_H

#include <stdint.h>

/* Tile t lists the segments members[starts[t]] to members[starts[t + 1] - 1]. */
struct tiles {
    double x, y, side; /* [m] lower left corner, side of a tile */
    int64_t columns, rows;
    const int32_t *starts, *members;
    int64_t n_everywhere;
    const int32_t *everywhere; /* segments too long to be listed in tiles */
    int64_t *tile_marks;       /* (columns * rows,) and (n_segments,): equal to `mark`: done in this scan */
    int64_t *segment_marks;
    int64_t mark;
};

#endif
