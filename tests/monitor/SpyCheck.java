// Starts lcm-spy in this process, waits until its table has the channels named as arguments, and prints each row:
// channel, type, messages, undecodable ones, once no more have come for 2 s. Ends with 1 if a channel is missing after 60 s.
import java.awt.Component;
import java.awt.Container;
import java.awt.Frame;
import java.lang.reflect.InvocationTargetException;
import java.util.HashMap;
import java.util.Map;
import javax.swing.JTable;
import javax.swing.SwingUtilities;
import javax.swing.table.TableModel;

public class SpyCheck {
  static JTable find(Component component) {
    if (component instanceof JTable) return (JTable) component;
    if (!(component instanceof Container)) return null;
    for (Component inner : ((Container) component).getComponents()) {
      JTable table = find(inner);
      if (table != null) return table;
    }
    return null;
  }

  static Map<String, String> rows() {
    Map<String, String> out = new HashMap<>();
    for (Frame frame : Frame.getFrames()) {
      JTable table = find(frame);
      if (table == null) continue;
      TableModel model = table.getModel();
      for (int row = 0; row < model.getRowCount(); row++) {
        Map<String, String> cells = new HashMap<>();
        for (int column = 0; column < model.getColumnCount(); column++)
          cells.put(model.getColumnName(column).trim(), String.valueOf(model.getValueAt(row, column)).trim());
        out.put(cells.get("Channel"), cells.get("Channel") + " " + cells.get("Type") + " " + cells.get("Num Msgs") + " " + cells.get("Undecodable"));
      }
    }
    return out;
  }

  public static void main(String[] channels) throws Exception {
    // Swing's threads would keep a process alive whose main thread has failed.
    Thread.currentThread().setUncaughtExceptionHandler((thread, error) -> { error.printStackTrace(); Runtime.getRuntime().halt(1); });
    Thread spy = new Thread(() -> lcm.spy.Spy.main(new String[0]));
    spy.setDaemon(true);
    spy.start();
    Map<String, String> rows = new HashMap<>(), before = new HashMap<>();
    boolean all = false;
    for (int i = 0, quiet = 0; i < 600 && (!all || quiet < 20); i++) {
      Thread.sleep(100);
      try {
        SwingUtilities.invokeAndWait(() -> { rows.clear(); rows.putAll(rows()); });
      } catch (InvocationTargetException changing) {
        continue;  // lcm-spy fills its table outside of Swing's thread: a row that is being added cannot be read
      }
      all = true;
      for (String channel : channels) all = all && rows.containsKey(channel);
      quiet = rows.equals(before) ? quiet + 1 : 0;
      before = new HashMap<>(rows);
    }
    for (String row : rows.values()) System.out.println(row);
    System.exit(all ? 0 : 1);
  }
}
