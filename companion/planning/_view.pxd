# C types of view.py, which is compiled as `_view`.
cimport cython
from libc cimport math
from companion.planning._arcs cimport Arcs
from companion.planning._segments cimport Segments

cdef double SIEVE_M, FAR, FIRST_STEPS
cdef long long BLOCK, GROUP, BEAMS, CHAIN_OVERLAP, MOST_CHAIN


cdef class View:
    cdef Arcs arcs
    cdef double[::1] mid_x, mid_y, spread, group_x, group_y, group_spread, away, hidden
    cdef long long[::1] block_first, chain, chain_count, ahead, seen, order
    cdef double eye_x, eye_y, u_x, u_y, wide, most, per_t, beside, sure_m
    cdef bint is_quarter
    cdef long long blocks, groups, seen_count

    @cython.locals(arcs=Arcs, ring=cython.longlong, first=cython.longlong, k=cython.longlong, end=cython.longlong)
    cdef void _divide(self) noexcept

    @cython.locals(begin=cython.longlong, last=cython.longlong, here=cython.longlong, after=cython.longlong)
    cdef void _add_blocks(self, long long first, long long end, long long size) noexcept

    @cython.locals(i=cython.longlong, block=cython.longlong, first=cython.longlong, end=cython.longlong, middle=cython.longlong, dx=double, dy=double, away=double)
    cdef void _set_blocks(self) noexcept

    @cython.locals(strip=double, block=cython.longlong, row=cython.longlong, n=cython.longlong, group=cython.longlong, end=cython.longlong, middle=cython.longlong, dx=double, dy=double, away=double)
    cdef _set_groups(self)

    @cython.locals(beam=cython.longlong)
    cdef void look(self, double x, double y, double u_x, double u_y, double wide, double more) noexcept

    @cython.locals(along=double, across=double)
    cdef bint shows(self, double dx, double dy) noexcept

    cdef long long _beam(self, double t) noexcept

    @cython.locals(along=double, slack=double)
    cdef bint _is_in_view(self, double dx, double dy, double spread) noexcept

    @cython.locals(left=cython.longlong, group=cython.longlong, dx=double, dy=double, within=double, farthest=double, kept=cython.longlong, n=cython.longlong)
    cdef void _see(self) noexcept

    @cython.locals(n=cython.longlong, block=cython.longlong, dx=double, dy=double)
    cdef void _see_group(self, long long group) noexcept

    @cython.locals(farthest2=double, beam=cython.longlong)
    cdef double _farthest(self) noexcept

    @cython.locals(s=Segments, reach=double, shrink=double, k=cython.longlong, low=double, high=double, far2=double, _=cython.longlong, dx=double, dy=double, along=double, t=double, narrower=double)
    cdef void _hide(self, long long block) noexcept

    @cython.locals(far=double, first=cython.longlong, end=cython.longlong, beam=cython.longlong)
    cdef void _lower(self, double low, double high, double far2) noexcept

    @cython.locals(dx=double, dy=double)
    cdef bint is_hidden(self, long long block) noexcept

    @cython.locals(near=double, across=double, low=double, high=double, nearest=double, first=cython.longlong, end=cython.longlong)
    cdef bint _is_behind(self, double dx, double dy, double spread) noexcept
