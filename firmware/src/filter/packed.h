/* packed.h - where U's elements are. Private to filter/. */
#ifndef PELORUS_FILTER_PACKED_H
#define PELORUS_FILTER_PACKED_H

/* First element (row 0) of column j in the packed strict upper triangle. */
static inline int column(int j)
{
    return j * (j - 1) / 2;
}

#endif
