"""A stand-in for what cancels objects: firmware with M486 (Marlin's CANCEL_OBJECTS), which leaves out moves, and a plug-in
that goes by comments, which leaves out all.

By OctoPrint's documented hooks (https://docs.octoprint.org/en/master/plugins/hooks.html): comments become @-commands while a
file is stored, what is queued is left out or not, and what was sent from a file is written down beside the settings.
"""

import re

import octoprint.filemanager.util
import octoprint.plugin

MARK = re.compile(rb"; (stop )?printing object (\S+)")
PARAMETER = re.compile(r"([SP])(-?\d+)")


class Marked(octoprint.filemanager.util.LineProcessorStream):
    def process_line(self, line):
        found = MARK.match(line)
        return line if found is None else b"@object " + (b"" if found[1] else found[2]) + b"\n"


class CancelObject(octoprint.plugin.OctoPrintPlugin):
    names = []
    cancelled = set()
    number = -1
    named = ""

    def stored(self, path, file_object, *args, **kwargs):
        marked = Marked(file_object.stream())
        return octoprint.filemanager.util.StreamWrapper(file_object.filename, marked)

    def marked(self, comm, phase, command, parameters, *args, **kwargs):
        if command == "object":
            self.named = parameters
            if parameters and parameters not in self.names:
                self.names.append(parameters)

    def queued(self, comm, phase, cmd, cmd_type, gcode, *args, **kwargs):
        if gcode == "M486":
            given = {letter: int(value) for letter, value in PARAMETER.findall(cmd.split("A")[0])}
            self.number = given.get("S", self.number)
            self.cancelled |= {given["P"]} if "P" in given else set()
        elif self.named and not cmd.startswith("@") and self.names.index(self.named) in self.cancelled:
            return (None,)
        elif self.number in self.cancelled and gcode in ("G0", "G1"):
            return (None,)

    def sent(self, comm, phase, cmd, cmd_type, gcode, *args, tags=None, **kwargs):
        if "source:file" in (tags or ()):
            with open(self.get_plugin_data_folder() + "/sent.gcode", "a") as log:
                log.write(cmd + "\n")


__plugin_name__ = "Cancel object, stood in for"
__plugin_version__ = "1"
__plugin_pythoncompat__ = ">=3,<4"


def __plugin_load__():
    global __plugin_implementation__, __plugin_hooks__
    it = __plugin_implementation__ = CancelObject()
    __plugin_hooks__ = {
        "octoprint.filemanager.preprocessor": it.stored,
        "octoprint.comm.protocol.atcommand.queuing": it.marked,
        "octoprint.comm.protocol.gcode.queuing": it.queued,
        "octoprint.comm.protocol.gcode.sent": it.sent,
    }
