"""German sentences for what other rooms say in English: notes, reasons, problems, rules.

Patterns with {places}: what stands in a place is put into German by the same tables, if they have it.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

_CAMERA = {
    "{view} is left out: {reason}.": "{view} ist ausgelassen: {reason}.",
    "{n} misfound corners of {view} are left out.": "{n} falsch gefundene Ecken von {view} sind ausgelassen.",
    "One misfound corner of {view} is left out.": "Eine falsch gefundene Ecke von {view} ist ausgelassen.",
    "A view without a name": "Eine Ansicht ohne Namen",
    "Only {n} views are used: take at least {least}, better 10 to 15.": (
        "Nur {n} Ansichten sind verwendet: mindestens {least} aufnehmen, besser 10 bis 15."
    ),
    "There is no corner in the {places} of the picture: take a view that reaches there.": (
        "Keine Ecke liegt hier im Bild: {places}; eine Ansicht aufnehmen, die dorthin reicht."
    ),
    (
        "The views are tilted by at most {tilt}° against each other: tilt the target by about 30° in different "
        "directions, or the focal length stays uncertain."
    ): (
        "Die Ansichten sind höchstens um {tilt}° gegeneinander geneigt: die Tafel um etwa 30° in verschiedene "
        "Richtungen neigen, sonst bleibt die Brennweite unsicher."
    ),
    "With fewer than six views two halves of them cannot be checked against each other.": (
        "Mit weniger als sechs Ansichten lassen sich zwei Hälften nicht gegeneinander prüfen."
    ),
    (
        "The target is bowed by {bow} mm from its lowest to its highest place, which is taken into account: better fix "
        "it to something flat."
    ): (
        "Die Tafel ist vom tiefsten zum höchsten Ort um {bow} mm gewölbt; das ist berücksichtigt. Besser auf etwas "
        "Ebenem befestigen."
    ),
    (
        "Corners of one view err together (a target that is not flat, blur, or a detector's bias): the standard "
        "deviations are {times} times those of independent corners."
    ): (
        "Ecken einer Ansicht weichen gemeinsam ab (Tafel nicht eben, Unschärfe oder Eckenfinder): die "
        "Standardabweichungen sind {times}-mal die unabhängiger Ecken."
    ),
    (
        "Corners of the target err alike in every view (a print that is not true): the standard deviations are {times} "
        "times those of independent corners."
    ): (
        "Ecken der Tafel weichen in jeder Ansicht gleich ab (Druck nicht maßhaltig): die Standardabweichungen sind "
        "{times}-mal die unabhängiger Ecken."
    ),
    (
        "{view} fits {times} times worse than most views ({rms} px against {usual} px): look at its corners, and take "
        "it again or leave it out."
    ): (
        "{view} passt {times}-mal schlechter als die meisten Ansichten ({rms} px gegen {usual} px): die Ecken ansehen, "
        "neu aufnehmen oder weglassen."
    ),
    "{n} of {all} views are left out by hand: {names}.": "{n} von {all} Ansichten sind von Hand ausgelassen: {names}.",
    "{n} of {all} views show no usable target, the first {name}: {reason}.": (
        "{n} von {all} Ansichten zeigen keine brauchbare Tafel, als erste {name}: {reason}."
    ),
    "upper left": "oben links",
    "top": "oben",
    "upper right": "oben rechts",
    "left": "links",
    "middle": "Mitte",
    "right": "rechts",
    "lower left": "unten links",
    "bottom": "unten",
    "lower right": "unten rechts",
    (
        "The camera was calibrated by another program and read from {name}: its standard deviations are not known, so "
        "no uncertainty here holds the camera's share."
    ): (
        "Die Kamera ist mit einem anderen Programm kalibriert und aus {name} gelesen: ihre Standardabweichungen sind "
        "nicht bekannt, und keine Unsicherheit hier enthält den Anteil der Kamera."
    ),
    "left out by hand": "von Hand ausgelassen",
    "its residuals (median {rms} px) are out of line with the other views' ({usual} px): blurred, moved, or not the "
    "same target": (
        "ihre Residuen (Median {rms} px) fallen aus denen der anderen Ansichten ({usual} px) heraus: unscharf, bewegt "
        "oder eine andere Tafel"
    ),
    "only {n} corners were found and a pose needs at least {least}": (
        "nur {n} Ecken sind gefunden, eine Pose braucht mindestens {least}"
    ),
    "its corners lie on one straight line": "ihre Ecken liegen auf einer Geraden",
    "its corners do not form the target's pattern: found in a wrong order, or another target": (
        "ihre Ecken bilden nicht das Muster der Tafel: falsche Reihenfolge oder eine andere Tafel"
    ),
    "only {n} of its {all} corners fit the camera": "nur {n} ihrer {all} Ecken passen zur Kamera",
    "no checkerboard is seen in the picture": "kein Schachbrett im Bild",
    "only a part of the board is in the picture: {n} of its {all} inner corners": (
        "nur ein Teil der Tafel ist im Bild: {n} ihrer {all} inneren Ecken"
    ),
    "the board shows {n} inner corners, not {all}": "die Tafel zeigt {n} innere Ecken, nicht {all}",
    "no grid of circles is seen in the picture": "kein Kreisraster im Bild",
    "no marker of {name} is seen in the picture": "kein Marker von {name} im Bild",
    "leave the picture out or take it again": "das Bild weglassen oder neu aufnehmen",
    "move the board so that the whole of it is seen, with its margin": "die Tafel ganz ins Bild rücken, mit ihrem Rand",
}

_FAN = {
    "{n} of {all} poses left out: {names}": "{n} von {all} Posen ausgelassen: {names}",
    (
        "the stripes are saturated at {share} of their points, which can shift them: expose shorter, dim the laser, or "
        "set channel in rig.toml to a colour in which the laser is weaker"
    ): (
        "die Streifen sind an {share} ihrer Punkte übersteuert und können dadurch verschoben sein: kürzer belichten, "
        "den Laser dämpfen oder in rig.toml als channel eine Farbe wählen, in der der Laser schwächer ist"
    ),
    (
        "the other poses foretell the stripes of {pose} to {error} mm only, those of a usual pose to {usual} mm: look "
        "at its pictures, or take more poses like it"
    ): (
        "die anderen Posen sagen die Streifen von {pose} nur auf {error} mm voraus, die einer gewöhnlichen auf {usual} "
        "mm: die Bilder ansehen oder mehr solche Posen aufnehmen"
    ),
    (
        "the plane target is bowed by {bow} mm from its lowest to its highest place, which is taken into account: "
        "better fix it to something flat"
    ): (
        "die Ebenentafel ist vom tiefsten zum höchsten Ort um {bow} mm gewölbt; das ist berücksichtigt. Besser auf "
        "etwas Ebenem befestigen"
    ),
    "the target moved by {shift} px between the pictures with the fan off and on": (
        "die Tafel hat sich zwischen den Bildern ohne und mit Fächer um {shift} px bewegt"
    ),
    "{pose}: with the fan on the target is not found, so it was not checked whether it moved": (
        "{pose}: mit Fächer ist die Tafel nicht zu finden; ob sie sich bewegt hat, ist daher nicht geprüft"
    ),
    "no stripe was found: is the fan on?": "kein Streifen gefunden: ist der Fächer an?",
    "no straight stripe was found on the target": "kein gerader Streifen auf der Tafel gefunden",
    "no stripe on the target agrees with the other poses": (
        "kein Streifen auf der Tafel stimmt mit den anderen Posen überein"
    ),
    "its stripes or target points fit {times} times worse than in the other poses": (
        "ihre Streifen oder Tafelpunkte passen {times}-mal schlechter als in den anderen Posen"
    ),
    "a further light plane is seen in {n} poses: check laser_fan.lines in rig.toml": (
        "in {n} Posen ist eine weitere Lichtebene zu sehen: laser_fan.lines in rig.toml prüfen"
    ),
    "one light plane: there is no pencil to hold it to": "eine Lichtebene: kein Büschel, an das sie zu binden wäre",
    "two planes at an unknown angle always are a pencil: nothing constrains them": (
        "zwei Ebenen in unbekanntem Winkel sind immer ein Büschel: nichts bindet sie"
    ),
    (
        "{finding} (fitted freely, the angles are {angles}, and the planes miss one axis by up to {gap} mm; p = {p}); "
        "{use}"
    ): (
        "{finding} (frei angepasst sind die Winkel {angles}, und die Ebenen verfehlen eine Achse um bis zu {gap} mm; "
        "p = {p}); {use}"
    ),
    "one common axis and angles of {angle}°: this suits the laser": (
        "eine gemeinsame Achse und Winkel von {angle}°: das passt zum Laser"
    ),
    "one common axis: this suits the laser": "eine gemeinsame Achse: das passt zum Laser",
    "{wanted}: this does not suit the laser": "{wanted}: das passt nicht zum Laser",
    "{wanted}: this does not suit the laser; its planes do share an axis, but not at these angles": (
        "{wanted}: das passt nicht zum Laser; seine Ebenen haben zwar eine Achse, aber andere Winkel"
    ),
    "one common axis and angles of {angle}°": "eine gemeinsame Achse und Winkel von {angle}°",
    "one common axis": "eine gemeinsame Achse",
    "the freely fitted planes are used": "verwendet sind die frei angepassten Ebenen",
    "a pencil with free angles is used": "verwendet ist ein Büschel mit freien Winkeln",
    "the constrained planes are used": "verwendet sind die gebundenen Ebenen",
    "{use}, as asked": "{use}, wie verlangt",
}

_SCAN = {
    "The relief under the fan fixes the scale to {share}.": (
        "Das Relief unter dem Fächer legt den Maßstab auf {share} fest."
    ),
    "The relief under the fan fixes the scale only to {share}: {error} mm on a height of {height} mm; {advice}.": (
        "Das Relief unter dem Fächer legt den Maßstab nur auf {share} fest: {error} mm auf {height} mm Höhe; {advice}."
    ),
    (
        "The fan meets no relief, so nothing fixes the scale of heights; {advice}. Its own points and flat faces are "
        "right all the same."
    ): (
        "Der Fächer trifft kein Relief, daher legt nichts den Höhenmaßstab fest; {advice}. Seine eigenen Punkte und "
        "ebene Flächen stimmen dennoch."
    ),
    "put a step beside the part, or let the fan meet more relief": (
        "eine Stufe neben das Teil stellen oder den Fächer auf mehr Relief richten"
    ),
    "{n} of {all} frames gave no points ({reason}): {names}": (
        "{n} von {all} Bildern gaben keine Punkte ({reason}): {names}"
    ),
    "{names} and others.": "{names} und andere.",
    "its light plane is too uncertain for any point to pass the σ cut": (
        "die Lichtebene ist zu unsicher, als dass ein Punkt die σ-Schranke einhielte"
    ),
    "its stripe crosses neither the fan nor another sweep": "der Streifen kreuzt weder Fächer noch andere Handlinien",
    "fewer than three crossings with the fan": "weniger als drei Kreuzungen mit dem Fächer",
    "object or camera moved between this frame and those that are used": (
        "Objekt oder Kamera hat sich zwischen diesem Bild und den verwendeten bewegt"
    ),
    "object or camera moved during the scan: the fan's light lies elsewhere than in the reference": (
        "Objekt oder Kamera hat sich während der Aufnahme bewegt: das Fächerlicht liegt anders als in der Referenz"
    ),
    "the fan's light is gone: object or camera moved far during the scan, or the three-line laser was off": (
        "das Fächerlicht fehlt: Objekt oder Kamera hat sich während der Aufnahme weit bewegt, oder der "
        "Drei-Linien-Laser war aus"
    ),
    "no stripe of the hand-held laser": "kein Streifen des handgeführten Lasers",
    "the picture is all black": "das Bild ist ganz schwarz",
    "the picture is all white": "das Bild ist ganz weiß",
    "its size {size} differs from the reference's {other}": "seine Größe {size} ist nicht die der Referenz, {other}",
    "There is no scan/reference.png: the darkest third of {n} frames stands for it, pixel by pixel.": (
        "scan/reference.png fehlt: dafür steht Pixel für Pixel das dunkelste Drittel von {n} Bildern."
    ),
    "{n} frames were lost while recording: camera, computer or disk were too slow.": (
        "{n} Bilder gingen beim Aufzeichnen verloren: Kamera, Rechner oder Platte waren zu langsam."
    ),
    "{n} frame was lost while recording: camera, computer or disk were too slow.": (
        "{n} Bild ging beim Aufzeichnen verloren: Kamera, Rechner oder Platte waren zu langsam."
    ),
    (
        "The room's light changed in {n} of {all} frames, the first {name}: the background is up to {share} % {which} "
        "than in the reference, which makes stripes less sure. Keep the light as it is during a scan, or scan again."
    ): (
        "Das Raumlicht änderte sich in {n} von {all} Bildern, zuerst in {name}: der Hintergrund ist bis zu {share} % "
        "{which} als in der Referenz, und Streifen sind dadurch weniger sicher. Das Licht während einer Aufnahme nicht "
        "ändern, oder neu aufnehmen."
    ),
    "brighter": "heller",
    "darker": "dunkler",
    (
        "Object or camera moved during the scan: {n} of {all} frames were left out, the first {name} (the fan's light "
        "is {shift} px or more aside, measured across its lines). Hold both still and scan again to use them all."
    ): (
        "Objekt oder Kamera hat sich während der Aufnahme bewegt: {n} von {all} Bildern sind ausgelassen, als erstes "
        "{name} (das Fächerlicht liegt quer zu seinen Linien {shift} px oder mehr daneben). Beide ruhig halten und neu "
        "aufnehmen, um alle zu verwenden."
    ),
    (
        "Object or camera moved {when}: crossings of the frames before and after disagree. Only {n} frames between "
        "which nothing moved are used. Hold both still and scan again to use them all."
    ): (
        "Objekt oder Kamera hat sich bewegt, {when}: Kreuzungen der Bilder davor und danach widersprechen sich. "
        "Verwendet sind nur {n} Bilder, zwischen denen sich nichts bewegte. Beide ruhig halten und neu aufnehmen, um "
        "alle zu verwenden."
    ),
    "between {first} and {second}": "zwischen {first} und {second}",
    (
        "Many crossings with the fan disagree with the sweeps; none was left out: check the fan's calibration, and "
        "that object and camera stood still."
    ): (
        "Viele Kreuzungen mit dem Fächer widersprechen den Handlinien; keine ist ausgelassen: die Kalibrierung des "
        "Fächers prüfen, und ob Objekt und Kamera ruhig standen."
    ),
    (
        "The sweeps' light planes have fallen together into one: no depth can be trusted. Move and tilt the hand-held "
        "laser more between frames, and cross the fan on object and table."
    ): (
        "Die Lichtebenen der Handlinien sind in eine zusammengefallen: keine Tiefe ist verlässlich. Den Handlaser "
        "zwischen den Bildern mehr bewegen und neigen und den Fächer auf Objekt und Tisch kreuzen."
    ),
    "Not used of the fan's light: {n} ({reason}).": "Vom Fächerlicht nicht verwendet: {n} ({reason}).",
    "{n} stretches": "{n} Stücke",
    "1 stretch": "1 Stück",
    "more than {n} stripes side by side: taken for a reflection": (
        "mehr als {n} Streifen nebeneinander: für eine Spiegelung gehalten"
    ),
    "no fan line fits between its neighbours": "keine Fächerlinie passt zwischen die Nachbarn",
    "it could be more than one of the fan's lines": "es könnte mehr als eine der Fächerlinien sein",
    (
        "The fan is {times} times further from where it was calibrated than the calibration allows: laser or camera "
        "have moved since, or the target was not true; calibrate the fan again."
    ): (
        "Der Fächer liegt {times}-mal weiter von seinem kalibrierten Ort, als die Kalibrierung zulässt: Laser oder "
        "Kamera haben sich seither bewegt, oder die Tafel war nicht maßhaltig; den Fächer neu kalibrieren."
    ),
}

_INSPECTION = {
    "No thickness was measured: {why}": "Es wurde keine Dicke gemessen: {why}",
    "point cloud: {what}": "Punktwolke: {what}",
    "feature {name}: {what}": "Merkmal {name}: {what}",
    "among {n} plane faces no two are parallel, so there is no thickness to measure": (
        "unter {n} ebenen Flächen sind keine zwei parallel, also gibt es keine Dicke zu messen"
    ),
    "scan both faces, or outline them as [gauge] upper_polygon_px and lower_polygon_px in rig.toml.": (
        "beide Flächen aufnehmen oder in rig.toml als [gauge] upper_polygon_px und lower_polygon_px umreißen."
    ),
    "The stated uncertainty does not hold {missing}.": "In der angegebenen Unsicherheit fehlt: {missing}.",
    "that of the sweeps' light planes": "die der Lichtebenen der Handlinie",
    "that of the camera": "die der Kamera",
    "that of the fan": "die des Fächers",
    "what the sweeps owe to the fan's speckle": "was die Handlinien dem Speckle des Fächers verdanken",
    "The stated uncertainties do not hold that of {missing}: they are less than is known.": (
        "In den angegebenen Unsicherheiten fehlt die von: {missing}. Sie sind kleiner als bekannt."
    ),
    "The stated uncertainties do not hold that of {missing}: they are less than is known, and prove nothing.": (
        "In den angegebenen Unsicherheiten fehlt die von: {missing}. Sie sind kleiner als bekannt und beweisen nichts."
    ),
    "the sweeps' light planes": "den Lichtebenen der Handlinie",
    "the camera": "der Kamera",
    "the fan": "dem Fächer",
    "There are no part coordinates: {why}": "Es gibt keine Werkstückkoordinaten: {why}",
    "there are no part coordinates.": "es gibt keine Werkstückkoordinaten.",
    "{name} was not measured as a plane, axis or point.": "{name} wurde nicht als Ebene, Achse oder Punkt gemessen.",
    "{name} was not measured.": "{name} wurde nicht gemessen.",
    "primary and secondary feature point in one direction.": (
        "erstes und zweites Bezugsmerkmal zeigen in eine Richtung."
    ),
    "Stated at 20 °C: {change} µm for a part at {celsius} °C.": (
        "Angegeben bei 20 °C: {change} µm für ein Teil bei {celsius} °C."
    ),
    "Compared with master {name}: {change} µm.": "Verglichen mit Normal {name}: {change} µm.",
    "Not compared with master {name}, whose length of {length} mm is too different.": (
        "Nicht mit Normal {name} verglichen, dessen Länge von {length} mm zu verschieden ist."
    ),
    "its region holds no measured point": "sein Bereich enthält keinen gemessenen Punkt",
    "draw it over what the scan covers, or allow a larger σ.": (
        "ihn über Aufgenommenes ziehen oder ein größeres σ zulassen."
    ),
    "its region holds {n} measured points but no plane face": (
        "sein Bereich enthält {n} gemessene Punkte, aber keine ebene Fläche"
    ),
    "draw it over a face that the scan covers.": "ihn über eine aufgenommene Fläche ziehen.",
    "the scan shows {n} plane faces, so there is none of number {number}": (
        "die Aufnahme zeigt {n} ebene Flächen, also keine mit Nummer {number}"
    ),
    "draw a region on the face.": "einen Bereich auf die Fläche ziehen.",
    "none of its {n} points lie on a cylinder": "keiner seiner {n} Punkte liegt auf einem Zylinder",
    "none of the {n} points beside the table's plane lie on a sphere": (
        "keiner der {n} Punkte neben der Tischebene liegt auf einer Kugel"
    ),
    "scan it with more sweeps, or draw a region on it.": (
        "mit mehr Handlinien aufnehmen oder einen Bereich darauf ziehen."
    ),
    "scan the sphere with more sweeps.": "die Kugel mit mehr Handlinien aufnehmen.",
    "{n} points are too few for it": "{n} Punkte sind dafür zu wenige",
    "{n} points are too few for a sphere": "{n} Punkte sind für eine Kugel zu wenige",
    "its points do not fix it: they lie on one line": "seine Punkte legen es nicht fest: sie liegen auf einer Linie",
    "scan it with more sweeps.": "mit mehr Handlinien aufnehmen.",
    "draw a larger region on it.": "einen größeren Bereich darauf ziehen.",
    "{n} level was found, and a step has two": "{n} Stufe gefunden, und eine Höhe braucht zwei",
    "scan the other ones too, or draw a region on each.": (
        "auch die anderen aufnehmen oder auf jede einen Bereich ziehen."
    ),
    "a stretch of {name} holds too few points": "ein Abschnitt von {name} enthält zu wenige Punkte",
    "make it longer.": "ihn verlängern.",
    "{n} measured points lie within {reach} mm of its plane": (
        "{n} gemessene Punkte liegen näher als {reach} mm an seiner Ebene"
    ),
    "cut where the scan covers the part, or take more points in.": (
        "dort schneiden, wo das Teil aufgenommen ist, oder mehr Punkte hinzunehmen."
    ),
    "{n} measured points lie within {reach} mm of the nominal surface": (
        "{n} gemessene Punkte liegen näher als {reach} mm an der Sollfläche"
    ),
    "check the alignment, or allow a larger reach_mm.": "die Ausrichtung prüfen oder ein größeres reach_mm zulassen.",
    "a point has no direction, so there is no angle to it": "ein Punkt hat keine Richtung, also keinen Winkel",
    "name planes or cylinders.": "Ebenen oder Zylinder nennen.",
    "mend {name} first.": "erst {name} berichtigen.",
    "its nominal surface was not read": "seine Sollfläche wurde nicht gelesen",
    "name an STL file in mm.": "eine STL-Datei in mm nennen.",
    "nothing but a plane was scanned, so there is no part to lay the nominal surface on": (
        "nur eine Ebene ist aufgenommen, also kein Teil, auf das die Sollfläche zu legen wäre"
    ),
    "the nominal surface cannot be laid on the scan: half of the points stay {left} mm and more off": (
        "die Sollfläche lässt sich nicht auf die Aufnahme legen: die Hälfte der Punkte bleibt {left} mm und mehr "
        "entfernt"
    ),
    "check that it is the file of this part, in mm, or align by features.": (
        "prüfen, ob es die Datei dieses Teils in mm ist, oder nach Merkmalen ausrichten."
    ),
    "it does not say where to cut": "es sagt nicht, wo zu schneiden ist",
    "give a line in the picture, or a plane.": "eine Linie im Bild oder eine Ebene angeben.",
    "its line or plane has no direction": "seine Linie oder Ebene hat keine Richtung",
    "draw a line between two different places.": "eine Linie zwischen zwei verschiedenen Orten ziehen.",
    "a thickness has two regions, the upper and the lower face": (
        "eine Dicke hat zwei Bereiche, die obere und die untere Fläche"
    ),
    "give both, or none.": "beide oder keinen angeben.",
    "part coordinates rest on a plane, and on a second plane or an axis.": (
        "Werkstückkoordinaten beruhen auf einer Ebene und einer zweiten Ebene oder Achse."
    ),
    "the tertiary plane fixes no third direction.": "die dritte Bezugsebene legt keine dritte Richtung fest.",
    "there are no part coordinates to align it by": "es gibt keine Werkstückkoordinaten, sie auszurichten",
    "give the plan a frame.": "dem Plan ein Bezugssystem geben.",
}

_FONTS = {
    (
        "No font of this computer has some of the East Asian characters in this report: the program that shows it has "
        "to bring them."
    ): (
        "Einige ostasiatische Zeichen dieses Berichts hat keine Schrift dieses Rechners: das anzeigende Programm muss "
        "sie mitbringen."
    ),
    "No font of this computer has some of the characters in this report: they are printed by their code points.": (
        "Einige Zeichen dieses Berichts hat keine Schrift dieses Rechners: sie stehen als Codepunkte da."
    ),
}

_RULES = {
    "distance of level {upper} from level {lower}, parallel planes fitted jointly to all levels": (
        "Abstand der Stufe {upper} von der Stufe {lower}, parallele Ebenen gemeinsam an alle Stufen angepasst"
    ),
    "range that holds 95 % of the deviations from the plane: {of}": (
        "Bereich, der 95 % der Abweichungen von der Ebene enthält: {of}"
    ),
    "means over cells of {side} mm": "Mittel über Zellen von {side} mm",
    (
        "distance of two parallel lines fitted jointly and robustly to one light profile, at right angles to them and "
        "along the reference normal"
    ): (
        "Abstand zweier paralleler Linien, gemeinsam und robust an ein Lichtprofil angepasst, rechtwinklig zu ihnen "
        "und längs der Bezugsnormalen"
    ),
    "distance of two parallel lines fitted jointly to two stretches of the section": (
        "Abstand zweier paralleler Linien, gemeinsam an zwei Abschnitte des Schnitts angepasst"
    ),
    "distance of the middles of two stretches of the section": "Abstand der Mitten zweier Abschnitte des Schnitts",
    "network": "Netz",
    "three-crossings": "drei Kreuzungen",
    "σ up to {limit} mm": "σ bis {limit} mm",
    "points, their noise included": "Punkte samt ihrem Rauschen",
}

_STUDIES = {
    "{n} repeats say little about the spread: {least} or more are asked for, 50 are usual.": (
        "{n} Wiederholungen sagen wenig über die Streuung: verlangt sind {least} oder mehr, üblich 50."
    ),
    "The spread would suffice; the bias does not: correct it, or calibrate anew.": (
        "Die Streuung würde genügen, die systematische Abweichung nicht: korrigieren oder neu kalibrieren."
    ),
    "The bias differs from zero (t-test, p = {p}).": (
        "Die systematische Abweichung ist von null verschieden (t-Test, p = {p})."
    ),
    "All values are the same: the resolution hides the spread.": (
        "Alle Werte sind gleich: die Auflösung verbirgt die Streuung."
    ),
    "The interaction of parts and operators is not significant (p > 0.05) and is pooled with the error.": (
        "Die Wechselwirkung von Teilen und Bedienern ist nicht signifikant (p > 0,05) und zum Fehler gerechnet."
    ),
    "One operator alone shows no reproducibility: gauge R&R is the repeatability.": (
        "Ein Bediener allein zeigt keine Vergleichspräzision: R&R ist die Wiederholpräzision."
    ),
    "{size} measurements are few: 10 parts, 3 operators and 2 to 3 repeats are usual.": (
        "{size} Messungen sind wenig: üblich sind 10 Teile, 3 Bediener und 2 bis 3 Wiederholungen."
    ),
    "{n} distinct categories: with fewer than {least} the gauge hardly tells these parts apart.": (
        "{n} unterscheidbare Klassen: mit weniger als {least} trennt das Messmittel diese Teile kaum."
    ),
    (
        "U of the mean holds the scatter of the repeats alone: no scan states its own uncertainty, so what is common "
        "to all of them (calibration) is not in it, and nothing is proven."
    ): (
        "U des Mittelwerts enthält nur die Streuung der Wiederholungen: keine Aufnahme gibt ihre Unsicherheit an, also "
        "fehlt das allen Gemeinsame (Kalibrierung), und nichts ist nachgewiesen."
    ),
    "Beyond the limits of the run chart: {names}; look for what changed there.": (
        "Außerhalb der Eingriffsgrenzen: {names}; dort nach einer Änderung suchen."
    ),
    "Acceptance check after the pattern of VDI/VDE 2634 part 2; not a certificate.": (
        "Annahmeprüfung nach dem Muster von VDI/VDE 2634 Blatt 2; kein Zertifikat."
    ),
    "{what}: {n} of the {all} positions the guideline asks for.": (
        "{what}: {n} der {all} Stellungen, die die Richtlinie verlangt."
    ),
    "{what}: no uncertainty of the artefact was stated; the verdict takes it as nothing.": (
        "{what}: zum Prüfkörper ist keine Unsicherheit angegeben; das Urteil rechnet sie als null."
    ),
    "probing error, form": "Antastabweichung, Form",
    "probing error, size": "Antastabweichung, Maß",
    "sphere-spacing error": "Kugelabstandsabweichung",
    "flatness error": "Ebenheitsmessabweichung",
}

GERMAN_NOTES: Mapping[str, str] = MappingProxyType(
    {**_CAMERA, **_FAN, **_SCAN, **_INSPECTION, **_FONTS, **_RULES, **_STUDIES}
)
