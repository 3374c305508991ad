"""The look of panels that stand above one another over the same time."""

from matplotlib.axes import Axes


def style_panel(axes: Axes, *, marker_scale: float = 1.0) -> None:
    """White ground, a thin grid, no frame at the top and right; a legend, if there is one, above it."""
    axes.set_facecolor("white")
    axes.grid(color="#d8d2c4", linewidth=0.6)
    axes.tick_params(labelsize=8.5)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(
            loc="lower right",
            bbox_to_anchor=(1.0, 0.98),
            fontsize=8,
            ncols=4,
            frameon=False,
            borderpad=0.1,
            markerscale=marker_scale,
        )
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
