// A link of the boat in short, of the name that its status has: a port's URL, or a name from the configuration.

const SERIAL = /^serial:(.*?)(?::\d+)?$/;
const NETWORK = /^(?:tcp|udp)(?:in|out)?:(.*):\d+$/;
const LOOPBACK = /^(?:127\.|localhost$|\[?::1\]?$)/;

export function linkName({ name, heard }, words) {
  const serial = SERIAL.exec(name);
  const network = NETWORK.exec(name);
  const short = serial
    ? words.say(/ttyUSB|ttyACM|usb/.test(serial[1]) ? "link.usb" : "link.serial")
    : network
      ? words.say(LOOPBACK.test(network[1]) ? "link.computer" : "link.network")
      : name;
  const stations = [...new Set((heard ?? []).map((address) => address.split("/")[0]))];
  return stations.length === 0 ? short : words.say("link.station", { name: short, n: stations.join(", ") });
}
