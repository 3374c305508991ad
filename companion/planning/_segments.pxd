# C types of segments.py, which is compiled as `_segments`.
cimport cython
from libc cimport math

cdef long long CELLS_PER_SEGMENT

@cython.locals(dx=double, dy=double, length2=double, ex=double, ey=double, along=double, cross=double)
cpdef double point_distance2(double px, double py, double ax, double ay, double bx, double by) noexcept

@cython.locals(p=double, q=double, a=double, b=double, best=double, other=double)
cpdef double segment_distance2(double ax, double ay, double bx, double by, double px, double py, double qx, double qy) noexcept


cdef class Segments:
    cdef public double[::1] ax, ay, bx, by
    cdef long long[::1] first, items
    cdef public double x0, y0, extent, cell
    cdef readonly long long count, columns, rows
    cdef long long lo, hi

    @cython.locals(pad=double, k=cython.longlong, low=cython.longlong, high=cython.longlong, row=cython.longlong, i=cython.longlong)
    cdef _fill(self, bint is_second)

    @cython.locals(total=cython.longlong, i=cython.longlong, count=cython.longlong)
    cdef long long _add_up(self)

    @cython.locals(i=cython.longlong)
    cdef _shift(self)

    @cython.locals(value=double)
    cdef long long row_of(self, double y) noexcept

    @cython.locals(value=double)
    cdef long long column_of(self, double x) noexcept

    @cython.locals(x_lo=double, x_hi=double, dy=double, y=double, t=double, s=double)
    cdef void set_span(self, double ax, double ay, double bx, double by, double reach, long long row) noexcept

    @cython.locals(low=cython.longlong, high=cython.longlong, is_up=bint, step=cython.longlong, row=cython.longlong, start=cython.longlong, end=cython.longlong, i=cython.longlong, k=cython.longlong)
    cpdef bint is_clear(self, double ax, double ay, double bx, double by, double[::1] limit2, double reach) noexcept

    @cython.locals(low=cython.longlong, high=cython.longlong, row=cython.longlong, start=cython.longlong, end=cython.longlong, i=cython.longlong, k=cython.longlong, within=double)
    cdef bint covers(self, double px, double py, double qx, double qy, double[::1] limit, double slack, double reach) noexcept

    @cython.locals(x=double, y=double, row=cython.longlong, start=cython.longlong, end=cython.longlong, i=cython.longlong, n=cython.longlong, least2=double, is_own=bint)
    cdef bint is_alone(self, long long k, long long after, double within, double[::1] limit, double reach) noexcept

    @cython.locals(dx=double, dy=double, farthest=double, reach=double, best=double, near=double, low=cython.longlong, high=cython.longlong, row=cython.longlong, start=cython.longlong, end=cython.longlong, i=cython.longlong, k=cython.longlong)
    cpdef double distance2(self, double ax, double ay, double bx, double by) noexcept

    @cython.locals(row=cython.longlong, column=cython.longlong, is_odd=bint, i=cython.longlong, k=cython.longlong, at=double, bin_column=cython.longlong)
    cpdef bint is_inside(self, double x, double y) noexcept

    @cython.locals(row=cython.longlong, start=cython.longlong, end=cython.longlong, i=cython.longlong)
    cpdef near(self, double x, double y, double reach)
