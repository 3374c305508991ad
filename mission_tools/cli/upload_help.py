"""What `mission-upload --help` says before its options."""

PROGRAM = "mission-upload"
EXAMPLES = f"""
Plan a mission, upload it, read it back and compare; then start it and follow it, if asked to.

SOURCE is a scenario (`lake`, or a .toml file), a map (.geojson) with --goal, or a mission that is ready
(QGroundControl's .plan, or .waypoints). Without it, --fence and --rally bring up theirs alone, and the boat
keeps its mission.

A fence file is a .plan, or .geojson with polygons, and circles as points with radius_m; the property kind is
inclusion (which they are without it) or exclusion. A map is a fence too: the outline of its water, without
what is solid or to keep out of. Rally points are points. A route is planned inside the fence and keeps the
clearance from its lines too.

A route starts at --start-at, else at the boat, else at the scenario's start. --contract adds a fence and
rally points from the map itself; --boat refuses a plan on which the boat would not come home.

Examples:

    {PROGRAM} lake --start --follow

    {PROGRAM} pool --case 3 --dry-run --preview pool.png

    {PROGRAM} pond.geojson --goal 29.4105,-82.1702 --clearance 3 --connect udp:0.0.0.0:14550

    {PROGRAM} lake --fence lake-fence.geojson --rally jetties.geojson --start

    {PROGRAM} lake --via 50.0001,-1.1975 --return --contract --boat lake --if-changed --start --follow

    {PROGRAM} --fence none

    {PROGRAM} survey.plan --connect /dev/ttyUSB0,57600 --sign-key radio.key --start

Exit codes: 0 done, 1 no route or the vehicle refused, 2 wrong usage or input, 3 no vehicle or link lost.
"""
