# C types of tangent_search.py, which is compiled as `_tangent_search`.
cimport cython
from libc cimport math
from companion.planning._tangents cimport Fan, Tangents

cdef double POSITION_TOLERANCE, GRAZE_M
cdef long long UNKNOWN, CLEAR, BLOCKED, FAN_FIELDS

@cython.locals(i=Py_ssize_t, grown="double[::1]")
cdef _more_doubles(double[::1] before)

@cython.locals(i=Py_ssize_t, grown="long long[::1]")
cdef _more_integers(long long[::1] before)


cdef class TangentSearch:
    cdef Tangents tangents
    cdef double[::1] best, best_at, at, cost, left_at, heap_f
    cdef long long[::1] node, parent, entry_from, entry_edge, heap
    cdef long long arrivals, entries, heap_size, bound_from
    cdef readonly long long expanded
    cdef readonly double bound
    cdef double goal_x, goal_y, bound_at
    cdef Fan start

    @cython.locals(node=cython.longlong)
    cpdef begin(self, double start_x, double start_y, double goal_x, double goal_y)

    @cython.locals(last=cython.longlong)
    cpdef bint is_done(self, long long tangents) except -1

    @cython.locals(label=cython.longlong, left_at=double, found=list)
    cpdef arcs(self)

    @cython.locals(label=cython.longlong, radius=double, fan=Fan, t=Tangents, k=cython.longlong, walk=double, g=double, other=cython.longlong, dx=double, dy=double, f=double)
    cdef _add_arrival(self, long long node, double at, double cost, long long parent, double left_at)

    @cython.locals(t=Tangents, node=cython.longlong, i=cython.longlong, side=double, radius=double, dx=double, dy=double, d2=double, square=double, scale=double, slack=double, length=double, u_x=double, u_y=double, departure=double, walk=double, total=double)
    cdef void _try_goal(self, long long label) noexcept

    @cython.locals(label=cython.longlong, k=cython.longlong, node=cython.longlong, radius=double, fan=Fan, t=Tangents, departure=double, at=double, walk=double, other=cython.longlong, g=double, potential=double, is_clear=bint, x=double, y=double)
    cdef _arrive(self, long long entry)

    @cython.locals(entry=cython.longlong, i=cython.longlong, up=cython.longlong)
    cdef _push(self, double f, long long label, long long k)

    @cython.locals(top=cython.longlong, size=cython.longlong, f=double, entry=cython.longlong, i=cython.longlong, down=cython.longlong)
    cdef long long _pop(self) noexcept
