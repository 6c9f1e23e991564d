<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE">
<context>
    <name>alarms</name>
    <message>
        <source>code</source>
        <translation>Code</translation>
    </message>
    <message>
        <source>cause</source>
        <translation>Ursache</translation>
    </message>
    <message>
        <source>Choose an alarm and acknowledge it. The journal records who did.</source>
        <translation>Alarm wählen und quittieren. Das Journal hält fest, wer quittiert hat.</translation>
    </message>
    <message>
        <source>what to do</source>
        <translation>Maßnahme</translation>
    </message>
    <message>
        <source>active</source>
        <translation>aktiv</translation>
    </message>
    <message>
        <source>Log in first (page Setup).</source>
        <translation>Zuerst anmelden (Seite Einrichten).</translation>
    </message>
    <message>
        <source>Choose an alarm first.</source>
        <translation>Zuerst einen Alarm wählen.</translation>
    </message>
    <message>
        <source>since</source>
        <translation>seit</translation>
    </message>
    <message>
        <source>until</source>
        <translation>bis</translation>
    </message>
    <message>
        <source>acknowledged by</source>
        <translation>quittiert von</translation>
    </message>
    <message>
        <source>Acknowledge</source>
        <translation>Quittieren</translation>
    </message>
</context>
<context>
    <name>camera</name>
    <message>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <source>grey levels</source>
        <translation>Graustufen</translation>
    </message>
    <message>
        <source>sharpness · best so far</source>
        <translation>Schärfe · beste bisher</translation>
    </message>
    <message>
        <source>Live image</source>
        <translation>Livebild</translation>
    </message>
    <message>
        <source>reason (required)</source>
        <translation>Grund (erforderlich)</translation>
    </message>
    <message>
        <source>mean brightness (0 to 255)</source>
        <translation>mittlere Helligkeit (0 bis 255)</translation>
    </message>
    <message>
        <source>saturated fraction</source>
        <translation>übersteuerter Anteil</translation>
    </message>
    <message>
        <source>ring radius · expected (px)</source>
        <translation>Ringradius · erwartet (px)</translation>
    </message>
    <message>
        <source>ring residual (px) · support</source>
        <translation>Ringabweichung (px) · Anteil</translation>
    </message>
    <message>
        <source>exposure</source>
        <translation>Belichtung</translation>
    </message>
    <message>
        <source>gain</source>
        <translation>Verstärkung</translation>
    </message>
    <message>
        <source>settings</source>
        <translation>Einstellungen</translation>
    </message>
    <message>
        <source>Saved and in use.</source>
        <translation>Gespeichert und in Gebrauch.</translation>
    </message>
    <message>
        <source>Nothing was changed:</source>
        <translation>Nichts wurde geändert:</translation>
    </message>
    <message>
        <source>Log in as setter first.</source>
        <translation>Zuerst als Einrichter anmelden.</translation>
    </message>
    <message>
        <source>Waiting for the engine...</source>
        <translation>Warten auf das Prüfprogramm ...</translation>
    </message>
</context>
<context>
    <name>data</name>
    <message>
        <source>OK</source>
        <translation>OK</translation>
    </message>
    <message>
        <source>NOK</source>
        <translation>NOK</translation>
    </message>
    <message>
        <source>ERROR</source>
        <translation>FEHLER</translation>
    </message>
    <message>
        <source>TEST</source>
        <translation>TEST</translation>
    </message>
    <message>
        <source>OFFLINE</source>
        <translation>OFFLINE</translation>
    </message>
    <message>
        <source>PLC LOST</source>
        <translation>SPS FEHLT</translation>
    </message>
    <message>
        <source>NO VERDICT</source>
        <translation>KEIN URTEIL</translation>
    </message>
    <message>
        <source>SERVICE</source>
        <translation>SERVICE</translation>
    </message>
    <message>
        <source>waiting for a part</source>
        <translation>wartet auf ein Teil</translation>
    </message>
    <message>
        <source>21 of 21 segments</source>
        <translation>21 von 21 Segmenten</translation>
    </message>
    <message>
        <source>master</source>
        <translation>Meisterteil</translation>
    </message>
    <message>
        <source>replay</source>
        <translation>Wiedergabe</translation>
    </message>
    <message>
        <source>result came too late for the PLC</source>
        <translation>Ergebnis kam zu spät für die SPS</translation>
    </message>
    <message>
        <source>hole</source>
        <translation>Loch</translation>
    </message>
    <message>
        <source>missing weld</source>
        <translation>fehlende Naht</translation>
    </message>
    <message>
        <source>no weld found</source>
        <translation>keine Naht gefunden</translation>
    </message>
    <message>
        <source>weld not wholly in view</source>
        <translation>Naht nicht vollständig im Bild</translation>
    </message>
    <message>
        <source>frame has the wrong size</source>
        <translation>Bild hat falsche Größe</translation>
    </message>
    <message>
        <source>frame incompletely grabbed</source>
        <translation>Bild unvollständig übertragen</translation>
    </message>
    <message>
        <source>image too dark</source>
        <translation>Bild zu dunkel</translation>
    </message>
    <message>
        <source>image too bright</source>
        <translation>Bild zu hell</translation>
    </message>
    <message>
        <source>image blurred</source>
        <translation>Bild unscharf</translation>
    </message>
    <message>
        <source>camera lost</source>
        <translation>Kamera verloren</translation>
    </message>
    <message>
        <source>no frame in time</source>
        <translation>Bild kam nicht rechtzeitig</translation>
    </message>
    <message>
        <source>deadline missed</source>
        <translation>Frist überschritten</translation>
    </message>
    <message>
        <source>classifier failed</source>
        <translation>Klassifikator ausgefallen</translation>
    </message>
    <message>
        <source>record could not be written</source>
        <translation>Datensatz konnte nicht geschrieben werden</translation>
    </message>
    <message>
        <source>aborted by the PLC</source>
        <translation>von der SPS abgebrochen</translation>
    </message>
    <message>
        <source>internal error</source>
        <translation>interner Fehler</translation>
    </message>
    <message>
        <source>camera</source>
        <translation>Kamera</translation>
    </message>
    <message>
        <source>simulated</source>
        <translation>simuliert</translation>
    </message>
    <message>
        <source>part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>the PLC has not enabled the station</source>
        <translation>die SPS hat die Station nicht freigegeben</translation>
    </message>
    <message>
        <source>the PLC has set the station offline</source>
        <translation>die SPS hat die Station offline gesetzt</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check the part&apos;s seat and the camera&apos;s position</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Sitz des Teils und Lage der Kamera prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, set width and height of the camera as in the settings</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Breite und Höhe der Kamera wie in den Einstellungen setzen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check network cable, switch and jumbo frames</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Netzkabel, Switch und Jumbo-Frames prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check the light and the exposure</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Licht und Belichtung prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check focus and glass, and that the part stands still</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Fokus und Glas prüfen, und ob das Teil still steht</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check power and cable of the camera</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Strom und Kabel der Kamera prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check the trigger line and camera.timeout_ms</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Triggerleitung und camera.timeout_ms prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, restart the station, restore the model file</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Station neu starten, Modelldatei wiederherstellen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check the archive&apos;s disk</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Platte des Archivs prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, send the engine&apos;s log to the maker</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Logdatei der Station an den Hersteller senden</translation>
    </message>
    <message>
        <source>no result within the deadline</source>
        <translation>kein Ergebnis innerhalb der Frist</translation>
    </message>
    <message>
        <source>see cycle times on the page Statistics; check the PC&apos;s load</source>
        <translation>Taktzeiten auf der Seite Statistik ansehen; Last des PCs prüfen</translation>
    </message>
    <message>
        <source>the PLC aborted the part</source>
        <translation>die SPS hat das Teil abgebrochen</translation>
    </message>
    <message>
        <source>TRIGGER_ID was 0 or repeated</source>
        <translation>TRIGGER_ID war 0 oder wiederholt</translation>
    </message>
    <message>
        <source>correct the PLC program: each part needs a new number</source>
        <translation>SPS-Programm berichtigen: jedes Teil braucht eine neue Nummer</translation>
    </message>
    <message>
        <source>TRIGGER or RESULT_ACK was held too long</source>
        <translation>TRIGGER oder RESULT_ACK zu lange gehalten</translation>
    </message>
    <message>
        <source>correct the PLC program: see the page Line</source>
        <translation>SPS-Programm berichtigen: siehe Seite Linie</translation>
    </message>
    <message>
        <source>check the network to the PLC</source>
        <translation>Netz zur SPS prüfen</translation>
    </message>
    <message>
        <source>check the PLC program and the network to the PLC</source>
        <translation>SPS-Programm und Netz zur SPS prüfen</translation>
    </message>
    <message>
        <source>a master was judged wrongly</source>
        <translation>ein Meisterteil wurde falsch beurteilt</translation>
    </message>
    <message>
        <source>check light, focus, glass and the surface of the parts</source>
        <translation>Licht, Fokus, Glas und Oberfläche der Teile prüfen</translation>
    </message>
    <message>
        <source>changed settings could not be used</source>
        <translation>geänderte Einstellungen unbrauchbar</translation>
    </message>
    <message>
        <source>login</source>
        <translation>Anmeldung</translation>
    </message>
    <message>
        <source>segment not seen</source>
        <translation>Segment nicht gesehen</translation>
    </message>
    <message>
        <source>unlike the training images</source>
        <translation>den Trainingsbildern unähnlich</translation>
    </message>
    <message>
        <source>frame not of this trigger</source>
        <translation>Bild nicht zu diesem Trigger</translation>
    </message>
    <message>
        <source>no structure</source>
        <translation>keine Struktur</translation>
    </message>
    <message>
        <source>too dark</source>
        <translation>zu dunkel</translation>
    </message>
    <message>
        <source>too bright</source>
        <translation>zu hell</translation>
    </message>
    <message>
        <source>blurred</source>
        <translation>unscharf</translation>
    </message>
    <message>
        <source>no weld between its borders</source>
        <translation>keine Naht zwischen den Grenzen</translation>
    </message>
    <message>
        <source>covered</source>
        <translation>verdeckt</translation>
    </message>
    <message>
        <source>login failed</source>
        <translation>Anmeldung gescheitert</translation>
    </message>
    <message>
        <source>logout</source>
        <translation>Abmeldung</translation>
    </message>
    <message>
        <source>user</source>
        <translation>Benutzer</translation>
    </message>
    <message>
        <source>setting</source>
        <translation>Einstellung</translation>
    </message>
    <message>
        <source>review</source>
        <translation>Nachprüfung</translation>
    </message>
    <message>
        <source>service</source>
        <translation>Service</translation>
    </message>
    <message>
        <source>alarm</source>
        <translation>Alarm</translation>
    </message>
    <message>
        <source>alarm over</source>
        <translation>Alarm vorbei</translation>
    </message>
    <message>
        <source>alarm acknowledged</source>
        <translation>Alarm quittiert</translation>
    </message>
    <message>
        <source>deleted</source>
        <translation>gelöscht</translation>
    </message>
    <message>
        <source>clock</source>
        <translation>Uhr</translation>
    </message>
    <message>
        <source>right</source>
        <translation>richtig</translation>
    </message>
    <message>
        <source>false call</source>
        <translation>Fehlalarm</translation>
    </message>
    <message>
        <source>missed defect</source>
        <translation>übersehener Fehler</translation>
    </message>
    <message>
        <source>not reviewed</source>
        <translation>nicht nachgeprüft</translation>
    </message>
    <message>
        <source>reviewed once</source>
        <translation>einmal nachgeprüft</translation>
    </message>
    <message>
        <source>two agree</source>
        <translation>zwei sind einig</translation>
    </message>
    <message>
        <source>disputed</source>
        <translation>strittig</translation>
    </message>
    <message>
        <source>check power and cable of the camera; the station reconnects automatically</source>
        <translation>Versorgung und Kabel der Kamera prüfen; die Station verbindet sich automatisch neu</translation>
    </message>
    <message>
        <source>free space on the archive&apos;s disk; check that it is writable</source>
        <translation>Platz auf dem Archivdatenträger schaffen; prüfen, ob er beschreibbar ist</translation>
    </message>
    <message>
        <source>the archive&apos;s disk is nearly full</source>
        <translation>Archivdatenträger fast voll</translation>
    </message>
    <message>
        <source>free space, or shorten the retention (archive.keep)</source>
        <translation>Platz schaffen oder die Aufbewahrung verkürzen (archive.keep)</translation>
    </message>
    <message>
        <source>PLC heartbeat lost</source>
        <translation>SPS-Heartbeat ausgefallen</translation>
    </message>
    <message>
        <source>self-test failed: the stored frame is judged differently</source>
        <translation>Selbsttest fehlgeschlagen: das gespeicherte Bild wird anders beurteilt</translation>
    </message>
    <message>
        <source>restart the station; if it comes back, check the PC&apos;s memory</source>
        <translation>Station neu starten; falls es wiederkehrt, Speicher des PCs prüfen</translation>
    </message>
    <message>
        <source>check master, light and focus; run the master check again</source>
        <translation>Meisterteil, Licht und Schärfe prüfen; Meisterteil erneut prüfen</translation>
    </message>
    <message>
        <source>master check is due</source>
        <translation>Prüfung der Meisterteile fällig</translation>
    </message>
    <message>
        <source>run the master check</source>
        <translation>Prüfung der Meisterteile durchführen</translation>
    </message>
    <message>
        <source>image drift detected</source>
        <translation>Bilddrift erkannt</translation>
    </message>
    <message>
        <source>see the engine&apos;s log; the previous settings stay active</source>
        <translation>siehe Protokoll der Engine; die bisherigen Einstellungen bleiben aktiv</translation>
    </message>
    <message>
        <source>the clock jumped: no old records are deleted</source>
        <translation>Uhr gesprungen: keine alten Aufzeichnungen werden gelöscht</translation>
    </message>
    <message>
        <source>set the clock right, then say which dates are right: weldgate records clock</source>
        <translation>Uhr richtig stellen, dann angeben, welche Zeiten stimmen: weldgate records clock</translation>
    </message>
    <message>
        <source>the engine hung and ended itself</source>
        <translation>Engine hing und hat sich beendet</translation>
    </message>
    <message>
        <source>see the engine&apos;s log for what hung; check camera, disk and network cards</source>
        <translation>Protokoll der Engine zeigt, was hing; Kamera, Platte und Netzwerkkarten prüfen</translation>
    </message>
    <message>
        <source>check the program of the line</source>
        <translation>Programm der Linie prüfen</translation>
    </message>
    <message>
        <source>the connection was lost while the result was written</source>
        <translation>Verbindung beim Schreiben des Ergebnisses verloren</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check that a part is in the nest and in the camera&apos;s view</source>
        <translation>Teil neu prüfen; tritt es erneut auf: prüfen, ob ein Teil in der Aufnahme und im Blickfeld der Kamera liegt</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check light, glass and nest for dirt, shadow and glare</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Licht, Glas und Nest auf Schmutz, Schatten und Reflexe prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check light, focus and surface</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Licht, Fokus und Oberfläche prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check the trigger line: its edge must come after BUSY, once per part</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Triggerleitung prüfen: Flanke erst nach BUSY, einmal je Teil</translation>
    </message>
    <message>
        <source>operator</source>
        <translation>Bediener</translation>
    </message>
    <message>
        <source>setter</source>
        <translation>Einrichter</translation>
    </message>
    <message>
        <source>quality</source>
        <translation>Qualität</translation>
    </message>
    <message>
        <source>admin</source>
        <translation>Administrator</translation>
    </message>
    <message>
        <source>station</source>
        <translation>Station</translation>
    </message>
    <message>
        <source>PLC</source>
        <translation>SPS</translation>
    </message>
    <message>
        <source>idle</source>
        <translation>Inaktivität</translation>
    </message>
    <message>
        <source>asked to</source>
        <translation>auf Wunsch</translation>
    </message>
    <message>
        <source>window closed</source>
        <translation>Fenster geschlossen</translation>
    </message>
    <message>
        <source>the station&apos;s disk is nearly full</source>
        <translation>Datenträger der Station fast voll</translation>
    </message>
    <message>
        <source>cleared by RESULT_ACK</source>
        <translation>gelöscht durch RESULT_ACK</translation>
    </message>
    <message>
        <source>cleared by the next TRIGGER, not acknowledged</source>
        <translation>gelöscht durch den nächsten TRIGGER, nicht quittiert</translation>
    </message>
    <message>
        <source>cleared by the station: too old, offline or link lost, not acknowledged</source>
        <translation>von der Station gelöscht: zu alt, offline oder Verbindung fort, nicht quittiert</translation>
    </message>
    <message>
        <source>the disk was too slow</source>
        <translation>die Platte war zu langsam</translation>
    </message>
    <message>
        <source>the camera sent no image of this part</source>
        <translation>von diesem Teil kam kein Bild der Kamera</translation>
    </message>
    <message>
        <source>the image of this part was deleted</source>
        <translation>das Bild dieses Teils wurde gelöscht</translation>
    </message>
    <message>
        <source>no weld was found on this part</source>
        <translation>auf diesem Teil wurde keine Naht gefunden</translation>
    </message>
    <message>
        <source>no defect map: another model judged this part</source>
        <translation>keine Fehlerkarte: ein anderes Modell hat dieses Teil beurteilt</translation>
    </message>
    <message>
        <source>setup images</source>
        <translation>Einrichtbilder</translation>
    </message>
    <message>
        <source>over</source>
        <translation>vorbei</translation>
    </message>
    <message>
        <source>another user logged in</source>
        <translation>anderer Benutzer angemeldet</translation>
    </message>
    <message>
        <source>engine stopped</source>
        <translation>Engine beendet</translation>
    </message>
    <message>
        <source>another user is in service mode</source>
        <translation>anderer Benutzer ist im Servicebetrieb</translation>
    </message>
    <message>
        <source>too many changes of settings are waiting. Try again.</source>
        <translation>Zu viele Änderungen warten. Bitte wiederholen.</translation>
    </message>
    <message>
        <source>there was no pause between parts: nothing was changed. Try again.</source>
        <translation>Keine Pause zwischen den Teilen: nichts geändert. Bitte wiederholen.</translation>
    </message>
    <message>
        <source>the settings file had another value at the start</source>
        <translation>Einstellungsdatei enthielt beim Start einen anderen Wert</translation>
    </message>
    <message>
        <source>the settings file cannot be used: see the engine&apos;s log. The previous settings stay active.</source>
        <translation>Einstellungsdatei nicht verwendbar: siehe Protokoll der Engine. Die bisherigen Einstellungen bleiben aktiv.</translation>
    </message>
    <message>
        <source>there are no users yet: enter the code that &apos;weldgate commission&apos; makes</source>
        <translation>es gibt noch keine Benutzer: den Code eingeben, den „weldgate commission“ erzeugt</translation>
    </message>
    <message>
        <source>this PIN is too short for the level: an administrator must set one of 6 digits; &apos;weldgate commission&apos; makes a new administrator</source>
        <translation>diese PIN ist zu kurz für die Stufe: ein Administrator muss eine mit 6 Ziffern setzen; „weldgate commission“ macht einen neuen Administrator</translation>
    </message>
    <message>
        <source>this name exists: enter another one for the new administrator</source>
        <translation>diesen Namen gibt es: für den neuen Administrator einen anderen eingeben</translation>
    </message>
    <message>
        <source>wrong commissioning code: &apos;weldgate commission&apos; makes one</source>
        <translation>falscher Inbetriebnahme-Code: „weldgate commission“ erzeugt einen</translation>
    </message>
    <message>
        <source>commissioning code</source>
        <translation>Inbetriebnahme-Code</translation>
    </message>
    <message>
        <source>too short</source>
        <translation>zu kurz</translation>
    </message>
    <message>
        <source>a PIN of 4 to 12 digits is needed</source>
        <translation>eine PIN von 4 bis 12 Ziffern ist nötig</translation>
    </message>
    <message>
        <source>a PIN of 6 to 12 digits is needed</source>
        <translation>eine PIN von 6 bis 12 Ziffern ist nötig</translation>
    </message>
    <message>
        <source>PLC_HEARTBEAT does not change</source>
        <translation>PLC_HEARTBEAT ändert sich nicht</translation>
    </message>
    <message>
        <source>rule broken: TRIGGER while READY was 0</source>
        <translation>Regelbruch: TRIGGER bei READY 0</translation>
    </message>
    <message>
        <source>rule broken: TRIGGER dropped before TRIGGER_ACK</source>
        <translation>Regelbruch: TRIGGER vor TRIGGER_ACK zurückgenommen</translation>
    </message>
    <message>
        <source>rule broken: RESULT_ACK without RESULT_VALID</source>
        <translation>Regelbruch: RESULT_ACK ohne RESULT_VALID</translation>
    </message>
    <message>
        <source>rule broken: TRIGGER_ID 0 or repeated</source>
        <translation>Regelbruch: TRIGGER_ID 0 oder wiederholt</translation>
    </message>
    <message>
        <source>TRIGGER not accepted</source>
        <translation>TRIGGER nicht angenommen</translation>
    </message>
    <message>
        <source>rule broken: TRIGGER or RESULT_ACK held too long</source>
        <translation>Regelbruch: TRIGGER oder RESULT_ACK zu lange gehalten</translation>
    </message>
    <message>
        <source>a name of 1 to 40 characters is needed</source>
        <translation>ein Name von 1 bis 40 Zeichen ist nötig</translation>
    </message>
    <message>
        <source>at least one administrator is needed</source>
        <translation>mindestens ein Administrator ist nötig</translation>
    </message>
    <message>
        <source>unknown name or wrong PIN</source>
        <translation>Name unbekannt oder PIN falsch</translation>
    </message>
    <message>
        <source>a login of the level operator is needed</source>
        <translation>eine Anmeldung als Bediener ist nötig</translation>
    </message>
    <message>
        <source>a login of the level setter is needed</source>
        <translation>eine Anmeldung als Einrichter ist nötig</translation>
    </message>
    <message>
        <source>a login of the level quality is needed</source>
        <translation>eine Anmeldung als Qualität ist nötig</translation>
    </message>
    <message>
        <source>a login of the level admin is needed</source>
        <translation>eine Anmeldung als Administrator ist nötig</translation>
    </message>
    <message>
        <source>the second review needs the level quality</source>
        <translation>die zweite Nachprüfung braucht die Stufe Qualität</translation>
    </message>
    <message>
        <source>no connection to the engine</source>
        <translation>keine Verbindung zum Prüfprogramm</translation>
    </message>
    <message>
        <source>is working on the station</source>
        <translation>arbeitet an der Station</translation>
    </message>
    <message>
        <source>test image</source>
        <translation>Testbild</translation>
    </message>
    <message>
        <source>verdict cannot be trusted: see page Alarms</source>
        <translation>Urteil nicht verlässlich: siehe Seite Alarme</translation>
    </message>
    <message>
        <source>master check is due: the PLC releases no parts</source>
        <translation>Meisterteilprüfung fällig: die SPS gibt keine Teile frei</translation>
    </message>
    <message>
        <source>the station is starting</source>
        <translation>die Station startet</translation>
    </message>
    <message>
        <source>records cannot be written</source>
        <translation>Datensätze können nicht geschrieben werden</translation>
    </message>
    <message>
        <source>the inspection has stopped</source>
        <translation>die Prüfung steht</translation>
    </message>
    <message>
        <source>a recipe is being loaded</source>
        <translation>ein Rezept wird geladen</translation>
    </message>
    <message>
        <source>self-test failed</source>
        <translation>Selbsttest nicht bestanden</translation>
    </message>
    <message>
        <source>an image is being taken or settings are being loaded on request of a window</source>
        <translation>auf Anforderung eines Fensters wird ein Bild aufgenommen oder werden Einstellungen geladen</translation>
    </message>
    <message>
        <source>No connection to the engine.</source>
        <translation>Keine Verbindung zum Prüfprogramm.</translation>
    </message>
    <message>
        <source>the request came too late: nothing was done</source>
        <translation>die Anfrage kam zu spät: nichts wurde getan</translation>
    </message>
    <message>
        <source>internal error: see the engine&apos;s log</source>
        <translation>interner Fehler: siehe Logdatei der Station</translation>
    </message>
    <message>
        <source>there is no such alarm</source>
        <translation>diesen Alarm gibt es nicht</translation>
    </message>
    <message>
        <source>a reason is needed</source>
        <translation>ein Grund ist nötig</translation>
    </message>
    <message>
        <source>the camera cannot be used with these values: see the engine&apos;s log</source>
        <translation>die Kamera arbeitet mit diesen Werten nicht: siehe Logdatei der Station</translation>
    </message>
    <message>
        <source>not in the settings file at the start</source>
        <translation>beim Start nicht in der Einstellungsdatei</translation>
    </message>
    <message>
        <source>settings file</source>
        <translation>Einstellungsdatei</translation>
    </message>
    <message>
        <source>read again</source>
        <translation>neu gelesen</translation>
    </message>
    <message>
        <source>service mode</source>
        <translation>Service-Betrieb</translation>
    </message>
    <message>
        <source>bit by hand</source>
        <translation>Bit von Hand</translation>
    </message>
    <message>
        <source>counters</source>
        <translation>Zähler</translation>
    </message>
    <message>
        <source>begins</source>
        <translation>beginnt</translation>
    </message>
    <message>
        <source>user changed</source>
        <translation>Benutzer geändert</translation>
    </message>
</context>
<context>
    <name>field</name>
    <message>
        <source>allowed: </source>
        <translation>erlaubt: </translation>
    </message>
    <message>
        <source>allowed, each segment once: </source>
        <translation>erlaubt, jedes Segment einmal: </translation>
    </message>
</context>
<context>
    <name>history</name>
    <message>
        <source>from … to …</source>
        <translation>von … bis …</translation>
    </message>
    <message>
        <source>segment</source>
        <translation>Segment</translation>
    </message>
    <message>
        <source>A serial, or a prefix followed by *</source>
        <translation>Eine Seriennummer oder ihr Anfang und *</translation>
    </message>
    <message>
        <source>any time</source>
        <translation>jede Zeit</translation>
    </message>
    <message>
        <source>from</source>
        <translation>von</translation>
    </message>
    <message>
        <source>to</source>
        <translation>bis</translation>
    </message>
    <message>
        <source>last hour</source>
        <translation>letzte Stunde</translation>
    </message>
    <message>
        <source>last 8 hours</source>
        <translation>letzte 8 Stunden</translation>
    </message>
    <message>
        <source>last day</source>
        <translation>letzter Tag</translation>
    </message>
    <message>
        <source>last week</source>
        <translation>letzte Woche</translation>
    </message>
    <message>
        <source>reason</source>
        <translation>Grund</translation>
    </message>
    <message>
        <source>review</source>
        <translation>Nachprüfung</translation>
    </message>
    <message>
        <source>to be confirmed</source>
        <translation>zu bestätigen</translation>
    </message>
    <message>
        <source>Search</source>
        <translation>Suchen</translation>
    </message>
    <message>
        <source>Gallery</source>
        <translation>Galerie</translation>
    </message>
    <message>
        <source>newest {n} parts</source>
        <translation>neueste {n} Teile</translation>
    </message>
    <message>
        <source>{n} parts</source>
        <translation>{n} Teile</translation>
    </message>
    <message>
        <source>Reading images</source>
        <translation>Bilder werden gelesen</translation>
    </message>
    <message>
        <source>Computing the defect map</source>
        <translation>Fehlerkarte wird berechnet</translation>
    </message>
    <message>
        <source>comment</source>
        <translation>Kommentar</translation>
    </message>
    <message>
        <source>Verdict is right</source>
        <translation>Urteil stimmt</translation>
    </message>
    <message>
        <source>False call</source>
        <translation>Fehlalarm</translation>
    </message>
    <message>
        <source>Missed defect</source>
        <translation>Übersehen</translation>
    </message>
    <message>
        <source>touch the segments in which a defect was missed</source>
        <translation>Segmente antippen, in denen ein Fehler übersehen wurde</translation>
    </message>
    <message>
        <source>Defect map</source>
        <translation>Fehlerkarte</translation>
    </message>
    <message>
        <source>Table…</source>
        <translation>Tabelle…</translation>
    </message>
    <message>
        <source>Write the found parts as CSV</source>
        <translation>Gefundene Teile als CSV schreiben</translation>
    </message>
    <message>
        <source>Writing the table</source>
        <translation>Tabelle wird geschrieben</translation>
    </message>
    <message>
        <source>Exporting crops</source>
        <translation>Ausschnitte werden exportiert</translation>
    </message>
    <message>
        <source>{path}: {parts} parts written, {left_out} left out</source>
        <translation>{path}: {parts} Teile geschrieben, {left_out} ausgelassen</translation>
    </message>
    <message>
        <source>Export reviewed…</source>
        <translation>Nachgeprüfte exportieren…</translation>
    </message>
    <message>
        <source>log in to review</source>
        <translation>zum Nachprüfen anmelden</translation>
    </message>
    <message>
        <source>Folder for the crops of reviewed parts</source>
        <translation>Ordner für die Ausschnitte nachgeprüfter Teile</translation>
    </message>
    <message>
        <source>finding</source>
        <translation>Befund</translation>
    </message>
    <message>
        <source>score</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>verdict</source>
        <translation>Urteil</translation>
    </message>
    <message>
        <source>serial</source>
        <translation>Seriennummer</translation>
    </message>
    <message>
        <source>time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>part · trigger</source>
        <translation>Teil · Trigger</translation>
    </message>
    <message>
        <source>brightness · sharpness · saturated</source>
        <translation>Helligkeit · Schärfe · übersteuert</translation>
    </message>
    <message>
        <source>distance to the training images</source>
        <translation>Abstand zu den Trainingsbildern</translation>
    </message>
    <message>
        <source>limits</source>
        <translation>Grenzwerte</translation>
    </message>
    <message>
        <source>model · recipe</source>
        <translation>Modell · Rezept</translation>
    </message>
    <message>
        <source>origin · purpose</source>
        <translation>Herkunft · Zweck</translation>
    </message>
    <message>
        <source>findings</source>
        <translation>Befunde</translation>
    </message>
    <message>
        <source>no part</source>
        <translation>kein Teil</translation>
    </message>
    <message>
        <source>tolerated</source>
        <translation>geduldet</translation>
    </message>
    <message>
        <source>yes</source>
        <translation>ja</translation>
    </message>
    <message>
        <source>from (°)</source>
        <translation>von (°)</translation>
    </message>
    <message>
        <source>to (°)</source>
        <translation>bis (°)</translation>
    </message>
    <message>
        <source>length (mm)</source>
        <translation>Länge (mm)</translation>
    </message>
    <message>
        <source>width (mm)</source>
        <translation>Breite (mm)</translation>
    </message>
    <message>
        <source>area (mm²)</source>
        <translation>Fläche (mm²)</translation>
    </message>
    <message>
        <source>reported to the PLC</source>
        <translation>an die SPS gemeldet</translation>
    </message>
    <message>
        <source>ring x · y · radius · residual (px)</source>
        <translation>Ring x · y · Radius · Abweichung (px)</translation>
    </message>
    <message>
        <source>times of the steps (ms)</source>
        <translation>Zeiten der Schritte (ms)</translation>
    </message>
    <message>
        <source>model hash · configuration</source>
        <translation>Modell-Hash · Konfiguration</translation>
    </message>
    <message>
        <source>The record cannot be read.</source>
        <translation>Der Datensatz ist nicht lesbar.</translation>
    </message>
    <message>
        <source>The image cannot be read.</source>
        <translation>Das Bild ist nicht lesbar.</translation>
    </message>
    <message>
        <source>no</source>
        <translation>nein</translation>
    </message>
    <message>
        <source>unknown</source>
        <translation>unbekannt</translation>
    </message>
    <message>
        <source>worst segment: brightness {mean:.0f} · contrast {contrast:.2f} · sharpness {sharpness:.3f} · fine structure {structure:.2f} · saturated {saturated:.1%} · weld {weld:.0%} · visible {visible}</source>
        <translation>schlechtestes Segment: Helligkeit {mean:.0f} · Kontrast {contrast:.2f} · Schärfe {sharpness:.3f} · Feinstruktur {structure:.2f} · übersteuert {saturated:.1%} · Naht {weld:.0%} · sichtbar {visible}</translation>
    </message>
</context>
<context>
    <name>journal</name>
    <message>
        <source>everything</source>
        <translation>alles</translation>
    </message>
    <message>
        <source>time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>who</source>
        <translation>wer</translation>
    </message>
    <message>
        <source>action</source>
        <translation>Aktion</translation>
    </message>
    <message>
        <source>object</source>
        <translation>Gegenstand</translation>
    </message>
    <message>
        <source>before</source>
        <translation>vorher</translation>
    </message>
    <message>
        <source>after</source>
        <translation>nachher</translation>
    </message>
    <message>
        <source>reason</source>
        <translation>Grund</translation>
    </message>
    <message>
        <source>saved</source>
        <translation>gespeichert</translation>
    </message>
    <message>
        <source>removed</source>
        <translation>entfernt</translation>
    </message>
</context>
<context>
    <name>line</name>
    <message>
        <source>register</source>
        <translation>Register</translation>
    </message>
    <message>
        <source>name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>value</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>by</source>
        <translation>von</translation>
    </message>
    <message>
        <source>signal</source>
        <translation>Signal</translation>
    </message>
    <message>
        <source>No connection to the engine. The registers show their last values.</source>
        <translation>Keine Verbindung zum Prüfprogramm. Die Register zeigen die letzten Werte.</translation>
    </message>
    <message>
        <source>registers</source>
        <translation>Register</translation>
    </message>
    <message>
        <source>edges on the bus, newest first</source>
        <translation>Flanken auf dem Bus, neueste zuerst</translation>
    </message>
    <message>
        <source>Word order: the PLC must read TEST_U32 as 16#12345678 (305419896) and TEST_F32 as 123.456. Words sent:</source>
        <translation>Wortfolge: Die SPS muss TEST_U32 als 16#12345678 (305419896) und TEST_F32 als 123,456 lesen. Gesendete Worte:</translation>
    </message>
    <message>
        <source>If it reads 16#56781234, swap the words in the PLC or set plc.low_word_first.</source>
        <translation>Liest sie 16#56781234, die Worte in der SPS tauschen oder plc.low_word_first setzen.</translation>
    </message>
    <message>
        <source>Log in as setter first (page Setup).</source>
        <translation>Zuerst als Einrichter anmelden (Seite Einrichten).</translation>
    </message>
    <message>
        <source>note</source>
        <translation>Anmerkung</translation>
    </message>
    <message>
        <source>Service mode</source>
        <translation>Service-Betrieb</translation>
    </message>
    <message>
        <source>no bit</source>
        <translation>kein Bit</translation>
    </message>
    <message>
        <source>set one bit of STATUS by hand:</source>
        <translation>ein Bit von STATUS von Hand setzen:</translation>
    </message>
</context>
<context>
    <name>live</name>
    <message>
        <source>part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>serial</source>
        <translation>Seriennummer</translation>
    </message>
    <message>
        <source>recipe</source>
        <translation>Rezept</translation>
    </message>
    <message>
        <source>cycle</source>
        <translation>Takt</translation>
    </message>
    <message>
        <source>worst segment</source>
        <translation>schlechtestes Segment</translation>
    </message>
    <message>
        <source>parts</source>
        <translation>Teile</translation>
    </message>
    <message>
        <source>not judged</source>
        <translation>ohne Urteil</translation>
    </message>
    <message>
        <source>yield</source>
        <translation>Ausbeute</translation>
    </message>
    <message>
        <source>Hold</source>
        <translation>Halten</translation>
    </message>
    <message>
        <source>Defect map</source>
        <translation>Fehlerkarte</translation>
    </message>
    <message>
        <source>last NOK</source>
        <translation>letztes NOK</translation>
    </message>
    <message>
        <source>known</source>
        <translation>bekannt</translation>
    </message>
    <message>
        <source>UNLIKE TRAINING</source>
        <translation>UNBEKANNT</translation>
    </message>
    <message>
        <source>image</source>
        <translation>Bild</translation>
    </message>
    <message>
        <source>Test image</source>
        <translation>Testbild</translation>
    </message>
    <message>
        <source>Take an image now and judge it. Nothing is reported to the PLC.</source>
        <translation>Jetzt ein Bild aufnehmen und beurteilen. An die SPS wird nichts gemeldet.</translation>
    </message>
    <message>
        <source>Keep this image on the page. Lamp and counters continue.</source>
        <translation>Dieses Bild stehen lassen. Lampe und Zähler laufen weiter.</translation>
    </message>
    <message>
        <source>Show where the network sees defects on the last NOK part</source>
        <translation>Zeigen, wo das Netz auf dem letzten NOK-Teil Fehler sieht</translation>
    </message>
    <message>
        <source>NOK segments of the newest parts</source>
        <translation>NOK-Segmente der neuesten Teile</translation>
    </message>
    <message>
        <source>no image of this part</source>
        <translation>kein Bild dieses Teils</translation>
    </message>
    <message>
        <source>Computing the defect map</source>
        <translation>Fehlerkarte wird berechnet</translation>
    </message>
    <message>
        <source>DRIFTING</source>
        <translation>DRIFT</translation>
    </message>
    <message>
        <source>HELD</source>
        <translation>ANGEHALTEN</translation>
    </message>
    <message>
        <source>segment</source>
        <translation>Segment</translation>
    </message>
    <message>
        <source>no image yet</source>
        <translation>noch kein Bild</translation>
    </message>
</context>
<context>
    <name>login</name>
    <message>
        <source>Log in</source>
        <translation>Anmelden</translation>
    </message>
    <message>
        <source>Log out</source>
        <translation>Abmelden</translation>
    </message>
    <message>
        <source>name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>commissioning code</source>
        <translation>Inbetriebnahme-Code</translation>
    </message>
    <message>
        <source>PIN</source>
        <translation>PIN</translation>
    </message>
    <message>
        <source>Nobody is logged in.</source>
        <translation>Niemand ist angemeldet.</translation>
    </message>
    <message>
        <source>There are no users yet. &apos;weldgate commission&apos; on this computer shows a code; with it, enter a name and a PIN of 6 to 12 digits to become administrator.</source>
        <translation>Es gibt noch keine Benutzer. „weldgate commission“ zeigt auf diesem Rechner einen Code; damit Name und PIN von 6 bis 12 Ziffern eingeben, um Administrator zu werden.</translation>
    </message>
    <message>
        <source>Anyone can watch; every action needs a login. Five wrong PINs lock a user for one minute.</source>
        <translation>Zusehen kann jeder; jede Aktion erfordert eine Anmeldung. Fünf falsche PINs sperren einen Benutzer für eine Minute.</translation>
    </message>
    <message>
        <source>Locked for one minute after five wrong PINs.</source>
        <translation>Nach fünf falschen PINs für eine Minute gesperrt.</translation>
    </message>
    <message>
        <source>Become administrator</source>
        <translation>Administrator werden</translation>
    </message>
</context>
<context>
    <name>masters</name>
    <message>
        <source>master</source>
        <translation>Meisterteil</translation>
    </message>
    <message>
        <source>expected</source>
        <translation>Soll</translation>
    </message>
    <message>
        <source>result</source>
        <translation>Ergebnis</translation>
    </message>
    <message>
        <source>last check</source>
        <translation>letzte Prüfung</translation>
    </message>
    <message>
        <source>due</source>
        <translation>fällig</translation>
    </message>
    <message>
        <source>state</source>
        <translation>Zustand</translation>
    </message>
    <message>
        <source>time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>Check chosen master</source>
        <translation>Gewähltes Meisterteil prüfen</translation>
    </message>
    <message>
        <source>Insert a master, choose it here and check it. The PLC can request the check too (GOLDEN_CHECK).</source>
        <translation>Meisterteil einlegen, hier wählen und prüfen. Auch die SPS kann die Prüfung anfordern (GOLDEN_CHECK).</translation>
    </message>
    <message>
        <source>past checks</source>
        <translation>bisherige Prüfungen</translation>
    </message>
    <message>
        <source>No masters are defined. Add [golden.masters] to the settings file.</source>
        <translation>Es sind keine Meisterteile festgelegt. [golden.masters] in die Einstellungsdatei eintragen.</translation>
    </message>
    <message>
        <source>Log in as setter to check masters.</source>
        <translation>Zum Prüfen von Meisterteilen als Einrichter anmelden.</translation>
    </message>
    <message>
        <source>Choose a master first.</source>
        <translation>Zuerst ein Meisterteil wählen.</translation>
    </message>
    <message>
        <source>masters</source>
        <translation>Meisterteile</translation>
    </message>
    <message>
        <source>WRONG</source>
        <translation>FALSCH</translation>
    </message>
    <message>
        <source>DUE</source>
        <translation>FÄLLIG</translation>
    </message>
</context>
<context>
    <name>people</name>
    <message>
        <source>name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>level</source>
        <translation>Stufe</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>Operator: reviews. Setter: camera, service mode, masters. Quality: limits of the recipes. Administrator: users. Each level includes the levels before it.</source>
        <translation>Bediener: Nachprüfung. Einrichter: Kamera, Service-Betrieb, Meisterteile. Qualität: Grenzwerte der Rezepte. Administrator: Benutzer. Jede Stufe umfasst die Stufen davor.</translation>
    </message>
    <message>
        <source>users</source>
        <translation>Benutzer</translation>
    </message>
    <message>
        <source>Log in as administrator first.</source>
        <translation>Zuerst als Administrator anmelden.</translation>
    </message>
    <message>
        <source>add or change</source>
        <translation>anlegen oder ändern</translation>
    </message>
    <message>
        <source>PIN (4 to 12 digits; 6 from quality on)</source>
        <translation>PIN (4 bis 12 Ziffern; 6 ab Qualität)</translation>
    </message>
    <message>
        <source>Really remove?</source>
        <translation>Wirklich entfernen?</translation>
    </message>
</context>
<context>
    <name>recipe</name>
    <message>
        <source>recipe</source>
        <translation>Rezept</translation>
    </message>
    <message>
        <source>{kind}: threshold</source>
        <translation>{kind}: Schwelle</translation>
    </message>
    <message>
        <source>{kind}: minimum length (mm)</source>
        <translation>{kind}: Mindestlänge (mm)</translation>
    </message>
    <message>
        <source>part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>serial</source>
        <translation>Seriennummer</translation>
    </message>
    <message>
        <source>minimum brightness</source>
        <translation>Mindesthelligkeit</translation>
    </message>
    <message>
        <source>maximum dark fraction</source>
        <translation>maximaler dunkler Anteil</translation>
    </message>
    <message>
        <source>maximum saturated fraction</source>
        <translation>maximaler übersteuerter Anteil</translation>
    </message>
    <message>
        <source>minimum sharpness</source>
        <translation>Mindestschärfe</translation>
    </message>
    <message>
        <source>before</source>
        <translation>vorher</translation>
    </message>
    <message>
        <source>after</source>
        <translation>nachher</translation>
    </message>
    <message>
        <source>segment</source>
        <translation>Segment</translation>
    </message>
    <message>
        <source>score</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>What if?</source>
        <translation>Was wäre wenn?</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <source>reason (required)</source>
        <translation>Grund (erforderlich)</translation>
    </message>
    <message>
        <source>thresholds of single segments</source>
        <translation>Schwellen einzelner Segmente</translation>
    </message>
    <message>
        <source>released parts (NOK → OK): possible escapes</source>
        <translation>freigegebene Teile (NOK → OK): möglicher Durchschlupf</translation>
    </message>
    <message>
        <source>rejected parts (OK → NOK): possible false rejects</source>
        <translation>zurückgewiesene Teile (OK → NOK): mögliche Pseudofehler</translation>
    </message>
    <message>
        <source>Log in as quality to save.</source>
        <translation>Zum Speichern als Qualität anmelden.</translation>
    </message>
    <message>
        <source>Run the what-if before saving.</source>
        <translation>Vor dem Speichern „Was wäre wenn?“ ausführen.</translation>
    </message>
    <message>
        <source>A reason is required.</source>
        <translation>Ein Grund ist erforderlich.</translation>
    </message>
    <message>
        <source>Waiting for the engine...</source>
        <translation>Warten auf das Prüfprogramm ...</translation>
    </message>
    <message>
        <source>Judging the archive again</source>
        <translation>Archiv wird erneut beurteilt</translation>
    </message>
    <message>
        <source>{n} parts: {released} would be released, {rejected} rejected</source>
        <translation>{n} Teile: {released} würden freigegeben, {rejected} zurückgewiesen</translation>
    </message>
    <message>
        <source>{n} images of insufficient quality would now be judged; their verdict is unknown.</source>
        <translation>{n} Bilder mit bisher ungenügender Qualität würden nun beurteilt; ihr Urteil ist unbekannt.</translation>
    </message>
    <message>
        <source>The archive has no parts of this recipe, so the effect of the limits is unknown.</source>
        <translation>Das Archiv enthält keine Teile dieses Rezepts; die Wirkung der Grenzwerte ist unbekannt.</translation>
    </message>
    <message>
        <source>{n} parts were left out: judged by another model or not readable.</source>
        <translation>{n} Teile wurden ausgelassen: von einem anderen Modell beurteilt oder nicht lesbar.</translation>
    </message>
    <message>
        <source>{n} parts are unlike the training images: OK with model.novel = flag, not judged with error.</source>
        <translation>{n} Teile sind den Trainingsbildern unähnlich: OK mit model.novel = flag, nicht beurteilt mit error.</translation>
    </message>
    <message>
        <source>Saved and in use.</source>
        <translation>Gespeichert und in Gebrauch.</translation>
    </message>
    <message>
        <source>Nothing was changed:</source>
        <translation>Nichts wurde geändert:</translation>
    </message>
    <message>
        <source>limits</source>
        <translation>Grenzwerte</translation>
    </message>
</context>
<context>
    <name>replay</name>
    <message>
        <source>Choose…</source>
        <translation>Wählen…</translation>
    </message>
    <message>
        <source>folder with images</source>
        <translation>Ordner mit Bildern</translation>
    </message>
    <message>
        <source>recipe</source>
        <translation>Rezept</translation>
    </message>
    <message>
        <source>Judge</source>
        <translation>Beurteilen</translation>
    </message>
    <message>
        <source>Report…</source>
        <translation>Bericht…</translation>
    </message>
    <message>
        <source>newest of this station:</source>
        <translation>neueste dieser Station:</translation>
    </message>
    <message>
        <source>folder or another archive:</source>
        <translation>Ordner oder anderes Archiv:</translation>
    </message>
    <message>
        <source>Changed verdicts only</source>
        <translation>Nur geänderte Urteile</translation>
    </message>
    <message>
        <source>scale of the images</source>
        <translation>Maßstab der Bilder</translation>
    </message>
    <message>
        <source>image</source>
        <translation>Bild</translation>
    </message>
    <message>
        <source>on the line</source>
        <translation>an der Linie</translation>
    </message>
    <message>
        <source>now</source>
        <translation>jetzt</translation>
    </message>
    <message>
        <source>score</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>reason</source>
        <translation>Grund</translation>
    </message>
    <message>
        <source>images</source>
        <translation>Bilder</translation>
    </message>
    <message>
        <source>Log in first (page Setup).</source>
        <translation>Zuerst anmelden (Seite Einrichten).</translation>
    </message>
    <message>
        <source>The scale must be {low} to {high} µm/px.</source>
        <translation>Der Maßstab muss zwischen {low} und {high} µm/px liegen.</translation>
    </message>
    <message>
        <source>Choose a folder first.</source>
        <translation>Zuerst einen Ordner wählen.</translation>
    </message>
    <message>
        <source>Judging images</source>
        <translation>Bilder werden beurteilt</translation>
    </message>
    <message>
        <source>not reproducible: same networks and limits give another result than on the line</source>
        <translation>nicht reproduzierbar: gleiche Netze und Grenzwerte ergeben ein anderes Ergebnis als an der Linie</translation>
    </message>
    <message>
        <source>Folder for the report</source>
        <translation>Ordner für den Bericht</translation>
    </message>
    <message>
        <source>Writing the report</source>
        <translation>Bericht wird geschrieben</translation>
    </message>
    <message>
        <source>{n} images: {ok} OK, {nok} NOK, {error} not judged</source>
        <translation>{n} Bilder: {ok} OK, {nok} NOK, {error} nicht beurteilt</translation>
    </message>
    <message>
        <source>{n} compared with the line, {flips} verdicts differ</source>
        <translation>{n} mit der Linie verglichen, {flips} Urteile weichen ab</translation>
    </message>
    <message>
        <source>and {n} more</source>
        <translation>und {n} weitere</translation>
    </message>
</context>
<context>
    <name>setup</name>
    <message>
        <source>Login</source>
        <translation>Anmeldung</translation>
    </message>
    <message>
        <source>Camera</source>
        <translation>Kamera</translation>
    </message>
    <message>
        <source>Recipe</source>
        <translation>Rezept</translation>
    </message>
    <message>
        <source>Masters</source>
        <translation>Meisterteile</translation>
    </message>
    <message>
        <source>Users</source>
        <translation>Benutzer</translation>
    </message>
    <message>
        <source>Journal</source>
        <translation>Journal</translation>
    </message>
</context>
<context>
    <name>statistics</name>
    <message>
        <source>shift</source>
        <translation>Schicht</translation>
    </message>
    <message>
        <source>recipe</source>
        <translation>Rezept</translation>
    </message>
    <message>
        <source>not judged</source>
        <translation>ohne Urteil</translation>
    </message>
    <message>
        <source>yield</source>
        <translation>Ausbeute</translation>
    </message>
    <message>
        <source>the last</source>
        <translation>die letzten</translation>
    </message>
    <message>
        <source>Report…</source>
        <translation>Bericht…</translation>
    </message>
    <message>
        <source>reasons</source>
        <translation>Gründe</translation>
    </message>
    <message>
        <source>mean brightness</source>
        <translation>mittlere Helligkeit</translation>
    </message>
    <message>
        <source>grey levels</source>
        <translation>Graustufen</translation>
    </message>
    <message>
        <source>Refresh</source>
        <translation>Aktualisieren</translation>
    </message>
    <message>
        <source>Reset counters</source>
        <translation>Zähler zurücksetzen</translation>
    </message>
    <message>
        <source>Set the counters of the page Live and of the PLC to 0. The journal records it.</source>
        <translation>Zähler der Seite Live und der SPS auf 0 setzen. Das Journal hält es fest.</translation>
    </message>
    <message>
        <source>whole strip</source>
        <translation>ganzer Streifen</translation>
    </message>
    <message>
        <source>worst segment</source>
        <translation>schlechtestes Segment</translation>
    </message>
    <message>
        <source>Dirt on the glass shows in the worst segment weeks before it costs an OK.</source>
        <translation>Schmutz auf dem Glas zeigt sich im schlechtesten Segment Wochen, bevor er ein OK kostet.</translation>
    </message>
    <message>
        <source>worst score of a part</source>
        <translation>schlechtester Wert eines Teils</translation>
    </message>
    <message>
        <source>sharpness</source>
        <translation>Schärfe</translation>
    </message>
    <message>
        <source>saturated fraction</source>
        <translation>übersteuerter Anteil</translation>
    </message>
    <message>
        <source>distance to the training images</source>
        <translation>Abstand zu den Trainingsbildern</translation>
    </message>
    <message>
        <source>brightness</source>
        <translation>Helligkeit</translation>
    </message>
    <message>
        <source>contrast</source>
        <translation>Kontrast</translation>
    </message>
    <message>
        <source>fraction with a weld</source>
        <translation>Anteil mit Naht</translation>
    </message>
    <message>
        <source>visible fraction</source>
        <translation>sichtbarer Anteil</translation>
    </message>
    <message>
        <source>inspection time</source>
        <translation>Prüfdauer</translation>
    </message>
    <message>
        <source>shifts and recipes</source>
        <translation>Schichten und Rezepte</translation>
    </message>
    <message>
        <source>NOK segments by angle</source>
        <translation>NOK-Segmente nach Winkel</translation>
    </message>
    <message>
        <source>Log in first (page Setup).</source>
        <translation>Zuerst anmelden (Seite Einrichten).</translation>
    </message>
    <message>
        <source>Reading records</source>
        <translation>Datensätze werden gelesen</translation>
    </message>
    <message>
        <source>No parts yet.</source>
        <translation>Noch keine Teile.</translation>
    </message>
    <message>
        <source>Report file</source>
        <translation>Berichtsdatei</translation>
    </message>
    <message>
        <source>Writing the report</source>
        <translation>Bericht wird geschrieben</translation>
    </message>
</context>
<context>
    <name>window</name>
    <message>
        <source>Live</source>
        <translation>Live</translation>
    </message>
    <message>
        <source>History</source>
        <translation>Verlauf</translation>
    </message>
    <message>
        <source>Statistics</source>
        <translation>Statistik</translation>
    </message>
    <message>
        <source>Line</source>
        <translation>Linie</translation>
    </message>
    <message>
        <source>Alarms</source>
        <translation>Alarme</translation>
    </message>
    <message>
        <source>Setup</source>
        <translation>Einrichten</translation>
    </message>
    <message>
        <source>Replay</source>
        <translation>Wiedergabe</translation>
    </message>
    <message>
        <source>Switch between dark and light</source>
        <translation>Zwischen dunkel und hell wechseln</translation>
    </message>
    <message>
        <source>Keyboard on the screen</source>
        <translation>Bildschirmtastatur</translation>
    </message>
    <message>
        <source>SIMULATED CAMERA</source>
        <translation>SIMULIERTE KAMERA</translation>
    </message>
    <message>
        <source>REPLAY</source>
        <translation>WIEDERGABE</translation>
    </message>
    <message>
        <source>No connection to the engine. Reconnecting...</source>
        <translation>Keine Verbindung zum Prüfprogramm. Neuer Verbindungsaufbau ...</translation>
    </message>
    <message>
        <source>Log in</source>
        <translation>Anmelden</translation>
    </message>
</context>
<context>
    <name>work</name>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Another job is still running. Wait for it or cancel it.</source>
        <translation>Es läuft noch ein anderer Auftrag. Abwarten oder abbrechen.</translation>
    </message>
</context>
</TS>
