"""German words of the report, by the English ones."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

_HEAD = {
    "Measurement report": "Messbericht",
    "page {n} of {all}": "Seite {n} von {all}",
    "End of report {report}": "Ende des Berichts {report}",
    "Part": "Messgegenstand",
    "Serial number": "Seriennummer",
    "Customer": "Auftraggeber",
    "Laboratory": "Labor",
    "Operator": "Bearbeiter",
    "Temperatures": "Temperaturen",
    "Report": "Bericht",
    "Date and time": "Datum und Uhrzeit",
    "Sweeps located by": "Verfahren",
    "Rig": "Messaufbau",
    "Camera calibration": "Kamerakalibrierung",
    "Fan calibration": "Fächerkalibrierung",
    "Software": "Software",
    "Settings, SHA-256": "Einstellungen, SHA-256",
    "Inputs, SHA-256": "Eingaben, SHA-256",
    "not named": "nicht benannt",
    "age": "Alter",
    "air {value}": "Luft {value}",
    "part {value}": "Teil {value}",
    "no correction to 20 °C was made": "nicht auf 20 °C korrigiert",
    "{what} of {part}": "{what}: {part}",
    "Inspection": "Prüfung",
    "Point cloud": "Punktwolke",
    "Date, signature": "Datum, Unterschrift",
}

_RESULT = {
    "Result": "Ergebnis",
    "thickness": "Dicke",
    "Characteristic": "Merkmal",
    "nominal": "Nennwert",
    "permitted": "zulässig",
    "measured": "gemessen",
    "deviation": "Abweichung",
    "decision": "Entscheidung",
    "U": "U",
    "k": "k",
    "Conforming": "Konform",
    "Not conforming": "Nicht konform",
    "Not proven": "Nicht nachgewiesen",
    "No verdict": "Ohne Entscheidung",
    "Nominal value": "Nennwert",
    "Deviation from nominal": "Abweichung vom Nennwert",
    "Tolerance": "Toleranz",
    "Expanded uncertainty U": "Erweiterte Messunsicherheit U",
    "deviation {deviation} ± {U}": "Abweichung {deviation} ± {U}",
    "{low} to {high}": "{low} bis {high}",
    "at most {limit}": "höchstens {limit}",
    "at least {limit}": "mindestens {limit}",
    "unknown": "unbekannt",
    "uncertainty unknown": "Messunsicherheit unbekannt",
    "Triangles of the mesh": "Dreiecke des Netzes",
    "σ of depth, median": "σ der Tiefe, Median",
    "σ of depth, 95 % below": "σ der Tiefe, 95 % darunter",
    "Extent x, y, z": "Ausdehnung x, y, z",
    "{remarks} under “Notes and warnings” further on.": "{remarks} unter „Hinweise und Warnungen“ weiter hinten.",
    (
        "The decision on the part is the worst of those on its characteristics. Each is stated with U = k·u "
        "below; by ISO 14253-1 a deviation must stay within its tolerance even when it is enlarged by U."
    ): (
        "Die Entscheidung über das Teil ist die schlechteste über seine Merkmale. Jedes steht unten mit U = k·u; "
        "nach ISO 14253-1 muss eine Abweichung auch um U vergrößert in ihrer Toleranz bleiben."
    ),
    (
        "No pair of parallel faces was evaluated, so there is no thickness and no verdict: this report is of the cloud."
    ): (
        "Es wurde kein Paar paralleler Flächen ausgewertet, daher gibt es keine Dicke und keine Entscheidung: "
        "dieser Bericht beschreibt die Punktwolke."
    ),
    "± is the expanded uncertainty U = k·u with k = {k}": "± ist die erweiterte Messunsicherheit U = k·u mit k = {k}",
    ", which covers about {share} % of a normal distribution": (
        ", die etwa {share} % einer Normalverteilung überdeckt"
    ),
    "; u is the combined standard uncertainty.": "; u ist die kombinierte Standardunsicherheit.",
    "Without an uncertainty the value is no complete result of a measurement.": (
        "Ohne Messunsicherheit ist der Wert kein vollständiges Messergebnis."
    ),
    "No nominal value with a tolerance was given, so the result is stated without a verdict.": (
        "Es ist kein Nennwert mit Toleranz angegeben, daher steht das Ergebnis ohne Entscheidung."
    ),
    "The uncertainty is unknown, so neither conformity nor non-conformity is proven.": (
        "Die Messunsicherheit ist unbekannt, daher ist weder Konformität noch Nichtkonformität nachgewiesen."
    ),
    (
        "Conformity is proven: the deviation of {deviation} from the nominal value, enlarged by U = {U}, stays "
        "within the tolerance of {tolerance}."
    ): (
        "Konformität ist nachgewiesen: die Abweichung von {deviation} vom Nennwert bleibt, um U = {U} "
        "vergrößert, in der Toleranz von {tolerance}."
    ),
    (
        "Non-conformity is proven: the deviation of {deviation} from the nominal value, even lessened by U = "
        "{U}, is outside the tolerance of {tolerance}."
    ): (
        "Nichtkonformität ist nachgewiesen: die Abweichung von {deviation} vom Nennwert liegt selbst um U = {U} "
        "verkleinert außerhalb der Toleranz von {tolerance}."
    ),
    (
        "Neither conformity nor non-conformity is proven: a limit of the tolerance of {tolerance} lies inside "
        "the interval of {deviation} ± {U} (deviation and U). A smaller uncertainty is needed for a decision."
    ): (
        "Weder Konformität noch Nichtkonformität ist nachgewiesen: eine Grenze der Toleranz von {tolerance} "
        "liegt im Bereich {deviation} ± {U} (Abweichung und U). Für eine Entscheidung ist eine kleinere "
        "Messunsicherheit nötig."
    ),
}

_LIMITS = {
    "What this result does not cover": "Was dieses Ergebnis nicht umfasst",
    (
        "The thickness is the {rule}. It is no local length: form deviations of the faces are stated apart, as "
        "flatness."
    ): (
        "Die Dicke ist: {rule}. Sie ist kein örtliches Maß: Formabweichungen der Flächen sind gesondert als "
        "Ebenheit angegeben."
    ),
    "distance of two parallel planes fitted jointly and robustly to the points of both faces": (
        "Abstand zweier paralleler Ebenen, gemeinsam und robust an die Punkte beider Flächen angepasst"
    ),
    "distance of two parallel planes fitted to the points of both faces": (
        "Abstand zweier paralleler Ebenen, an die Punkte beider Flächen angepasst"
    ),
    (
        "The result rests on one scan. Repeatability over several scans is in it only where the uncertainty "
        "budget names it."
    ): (
        "Das Ergebnis beruht auf einer Aufnahme. Die Wiederholbarkeit über mehrere Aufnahmen ist nur enthalten, "
        "wo das Messunsicherheitsbudget sie nennt."
    ),
    "Faces turned away from the camera or in the shadow of a laser were not measured.": (
        "Von der Kamera abgewandte oder im Schatten eines Lasers liegende Flächen wurden nicht gemessen."
    ),
    "Surfaces turned away from the camera or in the shadow of a laser were not measured.": (
        "Von der Kamera abgewandte oder im Schatten eines Lasers liegende Oberflächen wurden nicht gemessen."
    ),
    "Each result is what its rule says, of the points that were measured; it is no local length.": (
        "Jedes Ergebnis ist, was seine Regel sagt, aus den gemessenen Punkten; es ist kein örtliches Maß."
    ),
    (
        "The decisions are made one by one: that all characteristics together conform is less probable than that "
        "each does."
    ): (
        "Die Entscheidungen gelten einzeln: dass alle Merkmale zugleich konform sind, ist weniger "
        "wahrscheinlich, als dass jedes es ist."
    ),
    (
        "The σ of a point is the standard uncertainty of its depth within this scan. What is common to all "
        "points (camera, fan) comes on top and is not in it."
    ): (
        "σ eines Punktes ist die Standardunsicherheit seiner Tiefe innerhalb dieser Aufnahme. Was allen Punkten "
        "gemeinsam ist (Kamera, Fächer), kommt hinzu und ist nicht enthalten."
    ),
    "Temperatures are those the operator stated; nothing is corrected to 20 °C.": (
        "Temperaturen sind die vom Bearbeiter angegebenen; nichts ist auf 20 °C korrigiert."
    ),
    "Temperature was not measured; nothing is corrected to 20 °C.": (
        "Die Temperatur wurde nicht gemessen; nichts ist auf 20 °C korrigiert."
    ),
    (
        "Lengths are stated at 20 °C only where a note of theirs says so; the temperatures used are those the "
        "plan states."
    ): (
        "Längen gelten nur dort für 20 °C, wo ein Hinweis zu ihnen es sagt; die verwendeten Temperaturen sind "
        "die des Prüfplans."
    ),
}

_RULES = {
    "range that holds 95 % of the deviations from the plane: points, their noise included": (
        "Bereich von 95 % der Abweichungen von der Ebene: Punkte mit ihrem Rauschen"
    ),
    "range that holds 95 % of the deviations from the sphere": "Bereich von 95 % der Abweichungen von der Kugel",
    "range that holds 95 % of the deviations from the cylinder": "Bereich von 95 % der Abweichungen vom Zylinder",
    "diameter of the sphere of least squares, by the points' covariance": (
        "Durchmesser der ausgleichenden Kugel, mit der Kovarianz der Punkte"
    ),
    "diameter of the cylinder of least squares, by the points' covariance": (
        "Durchmesser des ausgleichenden Zylinders, mit der Kovarianz der Punkte"
    ),
    "distance square to the plane": "Abstand senkrecht zur Ebene",
    "distance square to the axis": "Abstand senkrecht zur Achse",
    "distance of two points": "Abstand zweier Punkte",
    "angle of an axis and a plane": "Winkel zwischen Achse und Ebene",
    "angle of two planes, 0 to 90°": "Winkel zweier Ebenen, 0 bis 90°",
    "angle of two axes, 0 to 90°": "Winkel zweier Achsen, 0 bis 90°",
    "radius of the circle of least squares in the section": "Radius des ausgleichenden Kreises im Schnitt",
    "twice the deviation from the nominal surface that 95 % of the points do not exceed": (
        "das Doppelte der Abweichung von der Sollfläche, die 95 % der Punkte nicht überschreiten"
    ),
    "mean deviation from the nominal surface": "mittlere Abweichung von der Sollfläche",
}

_PICTURES = {
    "Measured surface": "Gemessene Oberfläche",
    "No point was measured, so there is no surface to show.": (
        "Es wurde kein Punkt gemessen, daher gibt es keine Fläche."
    ),
    "Mesh of {n} triangles": "Netz aus {n} Dreiecken",
    "Cloud of {n} points": "Wolke aus {n} Punkten",
    "height above the lower face": "Höhe über der unteren Fläche",
    "height above the farthest points, towards the camera": "Höhe über den fernsten Punkten, zur Kamera hin",
    (
        "{what}, in parallel projection, shaded; colour: {height}. Dimensions are those of the measured area. "
        "Blank: not measured."
    ): (
        "{what}, in Parallelprojektion, schattiert; Farbe: {height}. Maße sind die des gemessenen Bereichs. "
        "Leer: nicht gemessen."
    ),
    "One frame of the scan": "Ein Bild der Aufnahme",
    (
        "Frame {name}, brightened, with {crossings} of the hand-moved line and the fan. σ is the standard "
        "uncertainty of the depth of the points on the hand-moved line."
    ): (
        "Bild {name}, aufgehellt, mit {crossings} der handgeführten Linie mit dem Fächer. σ ist die "
        "Standardunsicherheit der Tiefe der Punkte auf der handgeführten Linie."
    ),
    "fan line, with its number": "Fächerlinie mit Nummer",
    "hand-moved line, coloured by σ of depth": "handgeführte Linie, Farbe: σ der Tiefe",
    "no depth": "ohne Tiefe",
    "crossing used": "verwendete Kreuzung",
    "Points the results rest on": "Punkte, auf denen die Ergebnisse beruhen",
    "Where in the picture the points lie that each result rests on; grey: other points of the cloud.": (
        "Wo im Bild die Punkte liegen, auf denen jedes Ergebnis beruht; grau: übrige Punkte der Wolke."
    ),
    "Upper face": "Obere Fläche",
    "Lower face": "Untere Fläche",
    "Residuals of both faces, or depth and σ of the cloud": "Residuen beider Flächen oder Tiefe und σ der Wolke",
    "Residuals of both faces": "Residuen beider Flächen",
    "Depth and its uncertainty over the picture": "Tiefe und ihre Unsicherheit über dem Bild",
    "Depth z from the camera": "Tiefe z von der Kamera",
    "Standard uncertainty σ of depth": "Standardunsicherheit σ der Tiefe",
    "Mean of the points in each cell of the picture; grey: no point.": (
        "Mittel der Punkte je Zelle des Bildes; grau: kein Punkt."
    ),
    (
        "Distance of the points from the fitted plane, mean per cell, towards the camera positive (orange); "
        "grey: no point. Along: to the right in the picture; across: upwards in the picture. Spread: share of "
        "the points per bin, what lies beyond counted in the last one."
    ): (
        "Abstand der Punkte von der angepassten Ebene, Mittel je Zelle, zur Kamera hin positiv (orange); grau: "
        "kein Punkt. Längs: im Bild nach rechts; quer: im Bild nach oben. Verteilung: Anteil der Punkte je "
        "Klasse, darüber Hinausgehendes in der letzten."
    ),
    "Face": "Fläche",
    "Upper": "Obere",
    "Lower": "Untere",
    "upper": "obere",
    "lower": "untere",
    "rms of the residuals, mm": "Effektivwert der Residuen, mm",
    "flatness (95 % of the points), mm": "Ebenheit (95 % der Punkte), mm",
    "angle between the faces, fitted freely": "Winkel zwischen den Flächen, frei angepasst",
    "along, mm": "längs, mm",
    "across, mm": "quer, mm",
    "Spread": "Verteilung",
    "residual, mm": "Residuum, mm",
    "points, %": "Punkte, %",
    "height, mm": "Höhe, mm",
    "deviation, mm": "Abweichung, mm",
    "Deviation from the nominal surface": "Abweichung von der Sollfläche",
    (
        "{name}: measured − nominal, outwards positive, as the camera sees it. Marks by quarters of the "
        "tolerance of {tolerance} mm: + ++ +++ outwards, − −− −−− inwards, with ! beyond it. Grey: not compared."
    ): (
        "{name}: Ist − Soll, nach außen positiv, aus Sicht der Kamera. Zeichen nach Vierteln der Toleranz von "
        "{tolerance} mm: + ++ +++ nach außen, − −− −−− nach innen, mit ! darüber hinaus. Grau: nicht verglichen."
    ),
}

_BUDGET = {
    "Uncertainty budget": "Messunsicherheitsbudget",
    "Uncertainty budget of {name}": "Messunsicherheitsbudget: {name}",
    "Input": "Eingangsgröße",
    "value": "Wert",
    "distribution": "Verteilung",
    "u(x)": "u(x)",
    "sensitivity": "Empfindl.",
    "u of it": "Beitrag",
    "share": "Anteil",
    "Combined standard uncertainty u": "Kombinierte Standardunsicherheit u",
    "Effective degrees of freedom ν_eff": "Effektive Freiheitsgrade ν_eff",
    "Expanded uncertainty U = k·u, k = {k}": "Erweiterte Messunsicherheit U = k·u, k = {k}",
    "normal": "normal",
    "rectangular": "Rechteck",
    "triangular": "Dreieck",
    "arcsine": "Arcsin (U-förmig)",
    "t": "t",
    "centreline noise of the points": "Mittellinienrauschen der Punkte",
    "centreline noise of the sweeps' points": "Mittellinienrauschen der Punkte der Handlinie",
    "light planes of the sweeps (network)": "Lichtebenen der Handlinie (Netz)",
    "centreline noise of the fan's points (speckle)": "Mittellinienrauschen der Fächerpunkte (Speckle)",
    "form of the faces beyond the stated noise": "Form der Flächen über das angegebene Rauschen hinaus",
    "camera calibration": "Kamerakalibrierung",
    "fan calibration": "Fächerkalibrierung",
    "scale of the targets": "Maßstab der Kalibriertafeln",
    "temperature of the part": "Temperatur des Teils",
    "expansion coefficient of the part": "Ausdehnungskoeffizient des Teils",
    "temperature of the calibration target": "Temperatur der Kalibriertafel",
    "expansion coefficient of the calibration target": "Ausdehnungskoeffizient der Kalibriertafel",
    "certificate of the master": "Kalibrierschein des Normals",
    "measurement of the master": "Messung des Normals",
    "which stripes were scanned (range of 95 %)": "welche Streifen aufgenommen wurden (Bereich von 95 %)",
    "repeatability of the scans": "Wiederholbarkeit der Aufnahmen",
    "repeatability of the scans, above their stated noise": "Wiederholbarkeit der Aufnahmen über ihr Rauschen hinaus",
    "uncertainty stated by each scan, as if common to all": (
        "Unsicherheit jeder Aufnahme, als allen gemeinsam angesetzt"
    ),
    "common to all scans, as given": "allen Aufnahmen gemeinsam, wie angegeben",
}

_STUDIES = {
    "Repeated scans": "Wiederholte Aufnahmen",
    "{scans} of the part": "{scans} des Teils",
    "; errors are measured − nominal value, {nominal} mm.": (
        "; Abweichungen sind gemessener Wert − Nennwert, {nominal} mm."
    ),
    "; no nominal value was given.": "; ein Nennwert ist nicht angegeben.",
    " The standard deviation is that of a single scan (over n − 1).": (
        " Die Standardabweichung ist die einer einzelnen Aufnahme (durch n − 1)."
    ),
    " They rest on {n} different calibrations.": " Sie beruhen auf {n} verschiedenen Kalibrierungen.",
    "mean, mm": "Mittelwert, mm",
    "mean error, mm": "mittlere Abweichung, mm",
    "RMSE, mm": "RMSE, mm",
    "standard deviation, mm": "Standardabweichung, mm",
    "largest error, mm": "größte Abweichung, mm",
    "Scan": "Aufnahme",
    "measured at": "gemessen am",
    "thickness, mm": "Dicke, mm",
    "U, mm": "U, mm",
    "error, mm": "Abw., mm",
    "calibration": "Kalibrierung",
    "the project": "im Projekt",
    "Thickness with ±U of each scan, in the order of measuring.": (
        "Dicke mit ±U jeder Aufnahme in der Reihenfolge des Messens."
    ),
    "number of the scan": "Nummer der Aufnahme",
    "mean": "Mittelwert",
    "upper limit": "obere Grenze",
    "lower limit": "untere Grenze",
    "upper control limit": "obere Eingriffsgrenze",
    "lower control limit": "untere Eingriffsgrenze",
    "reference": "Referenzwert",
    "reference + 0.1 T": "Referenzwert + 0,1 T",
    "reference − 0.1 T": "Referenzwert − 0,1 T",
    "Studies": "Untersuchungen",
    "Repeats of {name}": "Wiederholungen: {name}",
    "Type-1 gauge study": "Prüfmittelfähigkeit, Verfahren 1",
    "Gauge R&R (ANOVA)": "Prüfmittelfähigkeit, Verfahren 2 (ANOVA)",
    "Acceptance check after the pattern of VDI/VDE 2634-2": "Annahmeprüfung nach dem Muster von VDI/VDE 2634-2",
    "verdict": "Urteil",
    "n": "n",
    "T": "T",
    "p": "p",
    "Cg": "Cg",
    "Cgk": "Cgk",
    "ndc": "ndc",
    "RMSE": "RMSE",
    "error": "Abweichung",
    "bias": "systematische Abweichung",
    "s (n − 1)": "s (n − 1)",
    "largest error": "größte Abweichung",
    "U of the mean": "U des Mittelwerts",
    "%GRR of the total": "%GRR der Gesamtstreuung",
    "%GRR of T": "%GRR von T",
    "Source of variation": "Streuungsursache",
    "share of σ², %": "Anteil an σ², %",
    "of the total, %": "der Gesamtstreuung, %",
    "of T, %": "von T, %",
    "gauge R&R": "Messsystem (R&R)",
    "repeatability": "Wiederholpräzision",
    "reproducibility": "Vergleichspräzision",
    "operators": "Bediener",
    "interaction": "Wechselwirkung",
    "parts": "Teile",
    "total": "gesamt",
    "Quantity": "Größe",
    "positions": "Stellungen",
    "at": "bei",
    "limit, mm": "Grenze, mm",
    "conforming": "konform",
    "not conforming": "nicht konform",
    "not proven": "nicht nachgewiesen",
    "capable": "fähig",
    "not capable": "nicht fähig",
    "acceptable": "geeignet",
    "acceptable with reservations": "bedingt geeignet",
    "not acceptable": "nicht geeignet",
}

_EVIDENCE = {
    "inner corners": "innere Ecken",
    "checkerboard": "Schachbrett",
    "ChArUco board, {columns} × {rows} squares of {square} mm, markers {marker} mm": (
        "ChArUco-Tafel, {columns} × {rows} Felder von {square} mm, Marker {marker} mm"
    ),
    "asymmetric circle grid": "versetztes Kreisraster",
    "circle grid": "Kreisraster",
    "pitch": "Teilung",
    "black square": "schwarzes Quadrat",
    "side": "Seite",
    "{n} lines, {angle}° apart": "{n} Linien im Abstand von {angle}°",
    "1 line": "1 Linie",
    "{width} × {height} px, {channel} channel": "{width} × {height} px, Kanal {channel}",
    "Calibrations and rig": "Kalibrierungen und Messaufbau",
    "Calibration": "Kalibrierung",
    "id": "Kennung",
    "made": "erstellt",
    "SHA-256 of its file": "SHA-256 der Datei",
    "not known": "nicht bekannt",
    "under 1 hour": "unter 1 Stunde",
    "Camera": "Kamera",
    "Fixed laser (fan)": "Fester Laser (Fächer)",
    "Fixed laser (fan), planes in the camera's frame": "Fester Laser (Fächer), Ebenen im Kamerasystem",
    "Parameter": "Parameter",
    "standard deviation": "Std.-Abw.",
    "fixed": "fest",
    "skew": "Scherung",
    "Views": "Ansichten",
    "calibrated by another program": "mit einem anderen Programm kalibriert",
    "{n} of {all} used": "{n} von {all} verwendet",
    "Corner error": "Eckenfehler",
    "mean {mean} px, rms {rms} px": "Mittel {mean} px, Effektivwert {rms} px",
    "Coverage": "Abdeckung",
    "{share} % of the picture, tilts {tilt}°": "{share} % des Bildes, Neigungen {tilt}°",
    "Odd/even views": "Un-/gerade Ansichten",
    "{distance} mm apart over the work volume": "{distance} mm auseinander im Arbeitsraum",
    "too few views": "zu wenige Ansichten",
    "Line": "Linie",
    "normal (x, y, z)": "Normale (x; y; z)",
    "d, mm": "d, mm",
    "rms, mm": "Eff., mm",
    "to the next, ° (free fit)": "zur nächsten, ° (frei)",
    "Poses": "Posen",
    "{n} of {all} of the plane target used": "{n} von {all} der Ebenentafel verwendet",
    "Free planes from one pencil": "Freie Ebenen vom Büschel",
    "at most {gap} mm in the work volume": "höchstens {gap} mm im Arbeitsraum",
    "Check of the constraint": "Prüfung der Bedingung",
    "Picture": "Bild",
    "Camera target": "Kameratafel",
    "Plane target": "Ebenentafel",
    "Fixed laser": "Fester Laser",
    "Nominal": "Nennwert",
    "Frames and calibration pictures": "Bilder der Aufnahme und der Kalibrierung",
    "No frame was given": "Es lag kein Bild vor",
    ", {first} to {last}": ", {first} bis {last}",
    "; none left out": "; keines ausgelassen",
    "Left out because": "Ausgelassen, weil",
    "how many": "Anzahl",
    "which": "welche",
    " and {n} more": " und {n} weitere",
    "and {n} more, listed in {where}": "und {n} weitere, siehe {where}",
    "no reason recorded": "ohne vermerkten Grund",
    "Notes and warnings": "Hinweise und Warnungen",
    "Remarks of the operator": "Bemerkungen des Bearbeiters",
    "Software and settings": "Software und Einstellungen",
    "Method": "Verfahren",
    "Points kept": "Behaltene Punkte",
    "Free camera parameters": "Freie Kameraparameter",
    "all sweeps adjusted together as one network, tied to the fan and to each other by their crossings": (
        "alle Handlinien gemeinsam als ein Netz ausgeglichen, über ihre Kreuzungen mit dem Fächer und "
        "untereinander verbunden"
    ),
    "each sweep located from its own crossings with the fan (Sun et al. 2023, section 4)": (
        "jede Handlinie aus ihren eigenen Kreuzungen mit dem Fächer (Sun et al. 2023, Abschnitt 4)"
    ),
    "SHA-256 over version, method and settings:": "SHA-256 über Version, Verfahren und Einstellungen:",
    "Inputs": "Eingaben",
    "Inputs, each with its hash": "Eingaben, jede mit Prüfsumme",
    "No hashes of the inputs were given.": "Es lagen keine Prüfsummen der Eingaben vor.",
    ("SHA-256 of {inputs}, its first {n} characters; all of them in full are in run.json. Over all inputs together:"): (
        "SHA-256 von {inputs}, jeweils die ersten {n} Zeichen; vollständig in run.json. Über alle Eingaben zusammen:"
    ),
    "SHA-256 over all {inputs}; those of each are in run.json:": (
        "SHA-256 über alle {inputs}; die einzelnen in run.json:"
    ),
    "Signatures": "Unterschriften",
    "Left out of this report by choice: {sections}.": "In diesem Bericht bewusst weggelassen: {sections}.",
    "none": "keine",
}

_COUNTED = {
    "frame": "Bild",
    "frames": "Bildern",
    "view": "Ansicht",
    "views": "Ansichten",
    "pose": "Pose",
    "poses": "Posen",
    "point": "Punkt",
    "points": "Punkte",
    "crossing": "Kreuzung",
    "crossings": "Kreuzungen",
    "scan": "Aufnahme",
    "scans": "Aufnahmen",
    "remark": "Hinweis",
    "remarks": "Hinweise",
    "characteristic": "Merkmal",
    "characteristics": "Merkmale",
    "input": "Eingabe",
    "inputs": "Eingaben",
    "day": "Tag",
    "days": "Tage",
    "hour": "Stunde",
    "hours": "Stunden",
}

GERMAN: Mapping[str, str] = MappingProxyType(
    {**_HEAD, **_RESULT, **_LIMITS, **_RULES, **_PICTURES, **_BUDGET, **_STUDIES, **_EVIDENCE, **_COUNTED}
)
