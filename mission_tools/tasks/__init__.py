"""What boats do besides sailing from one place to another: tours, stations, surveys, following a shore.

Pure functions of a chart, each of which gives a `TaskRoute` (`task_route.py`): legs in the order of sailing,
each with a kind and a time to hold at its end. `mission_of` makes a mission of it. Places are Points of the
chart's frame; areas are shapely polygons with x = east and y = north.

    tour(chart, start, [Stop(place, hold_s, name), ...], PlanSettings(), any_order=True, is_return=True)
    survey(chart, start, SurveySettings(footprint_m=10.0, overlap=0.1, plan=PlanSettings()), area).route
    follow_shore(chart, start, ShoreSettings(near=place, distance_m=10.0, plan=PlanSettings()))
"""
