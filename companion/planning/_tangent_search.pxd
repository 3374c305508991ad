# C types of tangent_search.py, which is compiled as `_tangent_search`.
cimport cython
from libc cimport math
from companion.planning._arcs cimport Arcs
from companion.planning._tangents cimport Tangents

cdef double INF, POSITION_TOLERANCE, GRAZE_M
cdef long long TO_GOAL, MOST_TANGENTS, UNKNOWN, CLEAR, BLOCKED


cdef class TangentSearch:
    cdef Tangents tangents
    cdef double[::1] best, best_at, at, cost, left_at, heap_f
    cdef long long[::1] node, parent, entry_from, entry_edge, heap
    cdef long long arrivals, entries, heap_size, bound_from
    cdef readonly long long expanded
    cdef readonly double bound
    cdef double start_x, start_y, goal_x, goal_y, bound_at, aim_x, aim_y, aim_at, aim_cost
    cdef long long start_first, start_end, forgotten

    @cython.locals(t=Tangents, node=cython.longlong)
    cpdef begin(self, double start_x, double start_y, double goal_x, double goal_y)

    @cython.locals(last=cython.longlong, entry=cython.longlong)
    cpdef bint is_done(self, long long tangents) except -1

    @cython.locals(label=cython.longlong, left_at=double, found=list)
    cpdef turns(self)

    @cython.locals(label=cython.longlong, radius=double, first=cython.longlong, end=cython.longlong, t=Tangents, k=cython.longlong, walk=double, g=double, other=cython.longlong, dx=double, dy=double, f=double)
    cdef _add_arrival(self, long long node, double at, double cost, long long parent, double left_at)

    @cython.locals(t=Tangents, node=cython.longlong, i=cython.longlong, side=double, radius=double, at=double, x=double, y=double, dx=double, dy=double, d2=double, square=double, scale=double, slack=double, length=double, u_x=double, u_y=double, walk=double)
    cdef bint _aim(self, long long label) noexcept

    @cython.locals(a=Arcs, node=cython.longlong)
    cdef void _finish(self, long long label) noexcept

    @cython.locals(label=cython.longlong, k=cython.longlong, node=cython.longlong, radius=double, t=Tangents, departure=double, at=double, walk=double, other=cython.longlong, g=double, potential=double, is_clear=bint)
    cdef _arrive(self, long long entry)

    @cython.locals(entry=cython.longlong, i=cython.longlong, up=cython.longlong)
    cdef _push(self, double f, long long label, long long k)

    @cython.locals(top=cython.longlong, size=cython.longlong, f=double, entry=cython.longlong, i=cython.longlong, down=cython.longlong)
    cdef long long _pop(self) noexcept
