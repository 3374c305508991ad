cimport cython

@cython.locals(best=double)
cpdef double segment_distance2(double ax, double ay, double bx, double by, double px, double py, double qx, double qy) noexcept

@cython.locals(dx=double, dy=double, length2=double, ex=double, ey=double, along=double, cross=double)
cpdef double point_distance2(double px, double py, double ax, double ay, double bx, double by) noexcept

@cython.locals(p=double, q=double, a=double, b=double)
cpdef bint crosses(double ax, double ay, double bx, double by, double px, double py, double qx, double qy) noexcept
